// Linked into a second program with --wrap=__cpu_indicator_init: the same object files, but clones of verbs
// (kernels/isa.hpp) are chosen as on a processor without AVX-512. Resolvers run before anything else: no library here.
#include <cstdlib>

extern "C" {  // NOLINTBEGIN(bugprone-reserved-identifier): their names
extern unsigned __cpu_features2[] __attribute__((visibility("hidden")));  // of libgcc
int __real___cpu_indicator_init();

int __wrap___cpu_indicator_init() {
  const int status = __real___cpu_indicator_init();
  __cpu_features2[2] &= ~4u;  // what target_clones("arch=x86-64-v4") looks at; a compiler that looks elsewhere: below
  return status;
}
}  // NOLINTEND(bugprone-reserved-identifier)

namespace {

__attribute__((constructor)) void check() {
#ifndef __clang_analyzer__  // clang 14 knows no x86-64-v4 here
  if (__builtin_cpu_supports("x86-64-v4")) std::abort();
#endif
}

}  // namespace
