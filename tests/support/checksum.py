"""The checksum of a dataset, as src/io/checksum.hpp defines it."""
import numpy

MASK = (1 << 64) - 1


def mix(z):
    z = (z + 0x9e3779b97f4a7c15) & MASK
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9 & MASK
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb & MASK
    return z ^ (z >> 31)


def checksum(values):
    """That of src/io/checksum.hpp."""
    words = numpy.ascontiguousarray(values).reshape(-1).view(numpy.uint64 if values.dtype.itemsize == 8 else numpy.uint8)
    return sum(mix(int(word) ^ mix(n)) for n, word in enumerate(words)) & MASK
