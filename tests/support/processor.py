"""What the processor can do."""
import pathlib


def has_avx512():
    return " avx512f " in pathlib.Path("/proc/cpuinfo").read_text()
