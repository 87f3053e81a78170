// Under AddressSanitizer: memory that nobody can reach any more ends the program here, while Open MPI's plugins, which
// leave much behind when they go, are still there. tests/support/leaks.txt names what is not ours.
#pragma once

extern "C" void __lsan_do_leak_check() __attribute__((weak));  // NOLINT(bugprone-reserved-identifier): its name

namespace eulastic::test {

inline void check_leaks() {
  if (__lsan_do_leak_check) __lsan_do_leak_check();
}

}  // namespace eulastic::test
