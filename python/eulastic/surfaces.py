"""Bodies in a snapshot as pieces of its grid, and fields that are stored only in cells at a surface. Arrays are (nz, ny, nx)."""
import numpy


def dilate(label):
    """Returns the labels with one more layer of cells around each body, so that every point of the surface phi = 1/2 has a label."""
    for axis in range(3):
        for shift in (1, -1):
            label = numpy.where(label == 0, numpy.roll(label, shift, axis), label)
    return label


def span(used, periodic):
    """Returns the first cell and the number of cells of a body along one direction; across a periodic boundary the first may be
    negative."""
    n, occupied = len(used), numpy.flatnonzero(used)
    if not periodic:
        return occupied[0], occupied[-1] - occupied[0] + 1
    gaps = numpy.diff(numpy.append(occupied, occupied[0] + n))
    widest = gaps.argmax()
    start, extent = occupied[(widest + 1) % len(occupied)], n - gaps[widest] + 1
    return (start - n if start + extent / 2 >= n else start), extent


def body_pieces(fraction, label, periodic):
    """Yields for every label (label, its phi in a box around the body, index (k, j, i) of the first cell of that box)."""
    dilated = dilate(dilate(label))
    for body in numpy.unique(label[label > 0]):
        mine = (label == body) & (fraction > 0.01)  # remains that trail behind have no say in where it is
        if not mine.any():
            continue
        ranges = []
        for d in range(3):
            start, extent = span(mine.any(axis=tuple({0, 1, 2} - {d})), periodic[d])
            ranges.append(numpy.arange(start - 2, start + extent + 2))
        cells = numpy.ix_(*(i % n for i, n in zip(ranges, label.shape)))
        piece = numpy.where(dilated[cells] == body, fraction[cells], 0)
        for d, (i, n) in enumerate(zip(ranges, label.shape)):
            if not periodic[d]:  # behind a wall there is nothing
                piece[(slice(None),) * d + ((i < 0) | (i >= n),)] = 0
        yield int(body), piece, numpy.array([i[0] for i in ranges])


def enclosing(phi):
    """Returns the level of phi, at most 1/2, whose surface encloses the volume of the body; phi is taken as linear between cell
    centres."""
    fine, volume = phi, phi.sum()
    for axis in range(3):
        low, high = (numpy.take(fine, range(first, first + fine.shape[axis] - 1), axis) for first in (0, 1))
        thirds = [low + part * (high - low) for part in (1 / 6, 1 / 2, 5 / 6)]
        fine = numpy.concatenate(thirds, axis)
    descending = numpy.sort(fine, axis=None)[::-1]
    return min(0.5, descending[min(int(27 * volume), descending.size - 1)])


def spread(values):
    """Extends values that only some cells have, 0 in all others: each cell takes the weighted mean of those among the 27 cells
    around it."""
    def smooth(q):
        for axis in range(3):
            q = numpy.pad(q, [(1, 1) if d == axis else (0, 0) for d in range(3)])
            low, middle, high = (numpy.take(q, range(n, n + q.shape[axis] - 2), axis) for n in range(3))
            q = low + 2 * middle + high
        return q

    weight = smooth((values != 0).astype(float))
    return smooth(values) / numpy.where(weight > 0, weight, 1)


def sample(values, places, periodic):
    """Returns values interpolated linearly to positions (n, 3), x before y before z, in cells from the centre of the first cell.
    Across periodic boundaries (of z, y, x) the field repeats; beyond others it has the value of the last cell."""
    low = numpy.floor(places).astype(int)
    part, total = places - low, numpy.zeros(len(places))
    for corner in numpy.ndindex(2, 2, 2):
        cell = [index % n if wraps else numpy.clip(index, 0, n - 1)
                for index, n, wraps in zip((low + corner).T, values.shape[::-1], periodic[::-1])]
        total += numpy.prod(numpy.where(corner, part, 1 - part), axis=1) * values[cell[2], cell[1], cell[0]]
    return total


def at_points(values, places):
    """Returns values interpolated linearly to positions (n, 3), x before y before z, in cells from the centre of the first cell;
    cells without a value, 0, do not count."""
    low = numpy.clip(numpy.floor(places).astype(int), 0, numpy.array(values.shape[::-1]) - 2)
    part = numpy.clip(places - low, 0, 1)
    total, weights = numpy.zeros(len(places)), numpy.zeros(len(places))
    for corner in numpy.ndindex(2, 2, 2):
        i, j, k = (low + corner).T
        weight = numpy.prod(numpy.where(corner, part, 1 - part), axis=1) * (values[k, j, i] != 0)
        total += weight * values[k, j, i]
        weights += weight
    return total / numpy.where(weights > 0, weights, 1)
