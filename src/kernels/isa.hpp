// Compilation of kernels for several instruction sets. A routine marked EULASTIC_CLONES is compiled for the baseline
// (AVX2) and for AVX-512, and the loader selects one. Kernels inside it are always inlined, so that they are compiled
// with it; the routine itself must not be inlined, or it would be compiled for the baseline only. Contraction is off
// and fma explicit, so that both give the same bits.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__AVX512F__) && \
    !defined(EULASTIC_NO_CLONES)
#define EULASTIC_CLONES __attribute__((target_clones("arch=x86-64-v4", "default"), noinline))
#else
#define EULASTIC_CLONES
#endif
#define EULASTIC_INLINE [[gnu::always_inline]] inline
#define EULASTIC_BODY __attribute__((always_inline))  // for lambdas that a kernel calls for every point

namespace eulastic::kernels {

EULASTIC_INLINE double fma(double a, double b, double c) noexcept { return __builtin_fma(a, b, c); }

}  // namespace eulastic::kernels
