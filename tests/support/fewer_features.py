#!/usr/bin/python3
"""Runs a Python script as on a processor without AVX-512 or, with --oldest, on one without AVX2 and FMA as well.

usage: tests/support/fewer_features.py [--oldest] SCRIPT [ARGUMENT ...]

numpy and, with --oldest, the C library, Mesa and OpenBLAS then choose other variants of their functions, whose results differ in
the last bits. The script sets environment variables, which every program that SCRIPT starts inherits. It does not affect the
kernels of eulastic, which ask the processor itself (src/kernels/isa.hpp)."""
import os
import sys

try:
    from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__
except ImportError:  # before numpy 2
    from numpy.core._multiarray_umath import __cpu_dispatch__, __cpu_features__

NEW = "AVX512", "X86_V4"  # what numpy's names of features begin with
OLD = "AVX2", "FMA3", "X86_V3"
# The variables of glibc, of Mesa's software renderer and of OpenBLAS, which ignore what the processor does not have.
OLDEST = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F,-AVX512VL,-AVX2,-FMA", "GALLIUM_OVERRIDE_CPU_CAPS": "sse4.1",
          "OPENBLAS_CORETYPE": "Nehalem"}


def environment(oldest):
    """Returns {variable: value}. It adds features of this processor only to what is taken already: numpy warns about others."""
    taken = os.environ.get("NPY_DISABLE_CPU_FEATURES", "").split()
    taken += [name for name in __cpu_dispatch__ if __cpu_features__[name] and name.startswith(NEW + OLD * oldest)]
    return {**({"NPY_DISABLE_CPU_FEATURES": " ".join(taken)} if taken else {}), **(OLDEST if oldest else {})}


def main():
    words = sys.argv[1:]
    oldest = words[:1] == ["--oldest"]
    words = words[oldest:]
    if not words or words[0].startswith("-"):
        sys.exit(__doc__)
    os.environ.update(environment(oldest))
    os.execv(sys.executable, [sys.executable, *words])


if __name__ == "__main__":
    main()
