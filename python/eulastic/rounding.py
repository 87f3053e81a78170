"""Rounding for colour scales, lengths and bins with the same result on every processor.

A value that lies on a boundary in exact arithmetic may come out one unit in the last place above or below it: the logarithms,
sines and powers of numpy and of the C library differ by that much between processors. These functions count such a value as lying
on the boundary.
"""
import decimal

import numpy


def six_digits(value):
    """Returns the value to six significant digits as a decimal.Decimal; round-off of single precision does not reach the sixth
    digit."""
    return decimal.Decimal(f"{float(value):.5e}")


def round_up(value, digits=2):
    """Returns the smallest number of `digits` significant digits that is not below the value; nan if the value is not finite."""
    exact = six_digits(value)
    if not exact.is_finite():
        return float("nan")
    return float(exact.quantize(decimal.Decimal(1).scaleb(exact.adjusted() + 1 - digits), decimal.ROUND_CEILING))


def round_down(value):
    """Returns the largest number of the series ..., 1, 2, 5, 10, 20, ... that is not above the value, which must be positive."""
    exact = six_digits(value)
    power = decimal.Decimal(1).scaleb(exact.adjusted())
    return float(power * max(part for part in (1, 2, 5) if part * power <= exact))


def floor(values):
    """Returns the largest integers that are not above the values; a value less than 1e-9 below an integer counts as that integer."""
    return numpy.floor(numpy.asarray(values) + 1e-9).astype(int)
