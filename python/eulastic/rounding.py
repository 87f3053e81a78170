"""Rounding for colour scales, lengths and bins that gives the same on every processor.

A value that lies on a boundary in exact arithmetic may come out one unit in the last place above or below it: the logarithms,
sines and powers of numpy and of the C library differ that much between processors. These functions count such a value as lying
on the boundary."""
import decimal

import numpy


def six_digits(value):
    """The value to six significant digits, as a decimal.Decimal: round-off of single precision does not reach the sixth."""
    return decimal.Decimal(f"{float(value):.5e}")


def round_up(value, digits=2):
    """The smallest number of `digits` significant digits that is not below the value; nan if the value is not finite."""
    exact = six_digits(value)
    if not exact.is_finite():
        return float("nan")
    return float(exact.quantize(decimal.Decimal(1).scaleb(exact.adjusted() + 1 - digits), decimal.ROUND_CEILING))


def round_down(value):
    """The largest number of the series ..., 1, 2, 5, 10, 20, ... that is not above the value, which is positive."""
    exact = six_digits(value)
    power = decimal.Decimal(1).scaleb(exact.adjusted())
    return float(power * max(part for part in (1, 2, 5) if part * power <= exact))


def floor(values):
    """Whole numbers not above the values, as integers; a value less than 1e-9 below a whole number counts as that number."""
    return numpy.floor(numpy.asarray(values) + 1e-9).astype(int)
