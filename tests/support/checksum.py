"""The checksum of a dataset, as src/io/checksum.hpp defines it, and checkpoints with other values whose checksums are right."""
import h5py
import numpy

MASK = (1 << 64) - 1


def mix(z):
    z = (z + 0x9e3779b97f4a7c15) & MASK
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9 & MASK
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb & MASK
    return z ^ (z >> 31)


def checksum(values):
    """That of src/io/checksum.hpp."""
    words = numpy.ascontiguousarray(values).reshape(-1).view(f"u{values.dtype.itemsize}")
    return sum(mix(int(word) ^ mix(n)) for n, word in enumerate(words)) & MASK


def text_of(number):
    return numpy.array(f"{number:016x}".encode(), dtype="S16")[()]


def content(file):
    """The attribute of a checkpoint, as src/io/checkpoint.cpp defines it."""
    entries = [name.encode() + b" " + file[name].attrs["checksum"].astype("S16") for name in file]
    return sum(mix(checksum(numpy.frombuffer(entry, numpy.uint8))) for entry in entries) & MASK


def change(path, name, work, whole=True):
    """Puts work(values) in the place of a dataset of a checkpoint and gives it its checksum; `whole`: the file its content, too."""
    with h5py.File(path, "r+") as file:
        data = work(file[name][...])
        file[name][...] = data
        file[name].attrs.modify("checksum", text_of(checksum(data)))
        if whole:
            file.attrs.modify("content", text_of(content(file)))
