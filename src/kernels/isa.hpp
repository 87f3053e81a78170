// How kernels are compiled: a verb marked EULASTIC_CLONES exists twice, for the baseline (AVX2) and for AVX-512, and
// the loader picks one; the kernels in it are always inlined, so that they are cloned with it. Inlined itself it would
// be the baseline's. No contraction and explicit fma only: both clones give the same bits.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__AVX512F__) && \
    !defined(EULASTIC_NO_CLONES)
#define EULASTIC_CLONES __attribute__((target_clones("arch=x86-64-v4", "default"), noinline))
#else
#define EULASTIC_CLONES
#endif
#define EULASTIC_INLINE [[gnu::always_inline]] inline
#define EULASTIC_BODY __attribute__((always_inline))  // of a lambda that a kernel calls for every point

namespace eulastic::kernels {

EULASTIC_INLINE double fma(double a, double b, double c) noexcept { return __builtin_fma(a, b, c); }

}  // namespace eulastic::kernels
