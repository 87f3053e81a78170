"""Ellipsoids that rotate, are strained and tank-tread in Stokes shear u = y, viscosity 1 outside, with two of their axes in the plane
of the shear. In a linear flow the flow inside an ellipsoid is linear, too (Jeffery, Proc. R. Soc. A 102, 1922; Eshelby, Proc. R. Soc.
A 241, 1957): exactly for a drop without surface tension, and in the limit for a rigid ellipsoid. A membrane that tank-treads around
a fixed shape is that of Keller and Skalak (J. Fluid Mech. 120, 1982).
"""
import numpy

from .exact import added_by_walls, pi, runge_kutta

NODES, WEIGHTS = numpy.polynomial.legendre.leggauss(60)
NODES, WEIGHTS = (NODES + 1) / 2, WEIGHTS / 2
NODES, WEIGHTS = (NODES / (1 - NODES))**2, WEIGHTS * 2 * NODES / (1 - NODES)**3  # of the half line


def integrals(axes):
    """Returns Eshelby's 3-by-3 I_ij over 4 pi, for i != j a1 a2 a3/2 times the integral of 1/((a_i^2 + s)(a_j^2 + s) Delta) over s >
    0, on the diagonal three times that."""
    parts = numpy.square(axes)[:, None] + NODES
    found = numpy.einsum("in,jn,n->ij", 1 / parts, 1 / parts, WEIGHTS / numpy.sqrt(parts.prod(axis=0)))
    return numpy.prod(axes) / 2 * found * (1 + 2 * numpy.eye(3))


def resistance(axes):
    """Returns K. A rigid ellipsoid that is free to turn in the strain E_12 has the stresslet 2 K E_12 per volume, 5/2 for a sphere; a
    fluid one, `ratio` times as viscous, is strained at the rate K E_12/(K - 1 + ratio)."""
    return 1 / ((axes[0]**2 + axes[1]**2) * integrals(axes)[0, 1])


def flatness(axes):
    a, b, _ = numpy.square(axes)
    return (a - b) / (a + b)


def tank_treading(axes, ratio):
    """Returns the steady inclination in degrees and the rate at which the surface rotates, of Keller and Skalak's ellipsoid with
    axes[0] > axes[1]; NaN above largest_ratio, where there is no steady state."""
    a, b, _ = axes
    k = resistance(axes)
    rate = -k / (k - 1 + ratio) * a * b / (a * a - b * b)  # times cos 2 theta
    with numpy.errstate(invalid="ignore"):
        angle = numpy.arccos(1 / (flatness(axes) - 4 * rate * a * b / (a * a + b * b))) / 2
    return numpy.degrees(angle), rate * numpy.cos(2 * angle)


def largest_ratio(axes):
    """Returns the viscosity ratio above which that ellipsoid tumbles."""
    a, b, _ = axes
    return 1 - resistance(axes) * (1 - 4 * a * a * b * b / (a**4 - b**4) / (1 - flatness(axes)))


def images(box):
    """Returns the velocity gradient that walls and images add in the middle of a channel, with walls at y = +-box[1]/2, periodic in x
    and z, for a body with the stresslet S: (L_xy, L_yx) of S_xy = 1 and (L_xx, L_yy) of S_xx = -S_yy = 1. Walls are treated for each
    wave (kx, kz) as in exact.images_of_disc, images one by one, -3/(8 pi) x (x.S.x)/r^5, and as a sheet beyond a distance."""
    area, b, reach = box[0] * box[2], box[1] / 2, 60 * max(box)
    kx, kz = (2 * pi / side * numpy.arange(-n, n + 1) for side, n in ((side, int(5 * side / b)) for side in (box[0], box[2])))
    kx, kz = (q.ravel() for q in numpy.meshgrid(kx, kz))
    kx, kz = kx[kx**2 + kz**2 > 0], kz[kx**2 + kz**2 > 0]
    k = numpy.hypot(kx, kz)
    c, s, e = (kx / k)**2, (kz / k)**2, numpy.exp(-k * b)
    xy, yx, xx = added_by_walls(k, b)
    walls = numpy.array([(c * xy + s * k * e / (2 * numpy.sinh(k * b))).sum() + 1 / box[1], (c * yx).sum(),
                         (c * (1 + c) / 2 * xx + s * c * k * e / (2 * numpy.cosh(k * b))).sum(), -((1 + c) / 2 * xx).sum()]) / area
    x, z = numpy.meshgrid(*(side * numpy.arange(-int(reach / side), int(reach / side) + 1) for side in (box[0], box[2])))
    r = numpy.hypot(x, z)
    x, r = x[(r > 0) & (r < reach)], r[(r > 0) & (r < reach)]
    square, fourth = (x**2 / r**5).sum() + pi / (area * reach), (x**4 / r**7).sum() + .75 * pi / (area * reach)
    return walls - 3 / (8 * pi) * numpy.array([2 * square, 0, 3 * square - 5 * fourth, square])


def flow_in(shape, ratio, added):
    """Returns the velocity gradient in the plane and the strain rate along axis 3 in a drop whose ellipsoid is x.shape^-1.x = 1.
    `added`: images(box) of its stresslet 2 (ratio - 1) e per volume, found together with the flow by iteration."""
    squares, turn = numpy.linalg.eigh(shape[:2, :2])
    axes = numpy.sqrt([*squares, shape[2, 2]])
    eshelby = integrals(axes)
    shear = (axes[0]**2 + axes[1]**2) * eshelby[0, 1]
    uneven = numpy.eye(3) + (ratio - 1) * eshelby * numpy.square(axes)
    volume, there = 4 / 3 * pi * numpy.prod(axes), numpy.zeros((2, 2))
    for _ in range(3):
        far = numpy.array([[0, 1], [0, 0]]) + there
        strain = turn.T @ (far + far.T) @ turn / 2
        own = numpy.linalg.solve(uneven, [*numpy.diag(strain), -numpy.trace(strain)])
        e = numpy.diag(own[:2])
        e[0, 1] = e[1, 0] = strain[0, 1] / (1 + (ratio - 1) * shear)
        spin = (turn.T @ (far - far.T) @ turn)[1, 0] / 2 + flatness(axes) * (strain[0, 1] - e[0, 1])
        stresslet = 2 * (ratio - 1) * volume * turn @ e @ turn.T
        xx = (stresslet[0, 0] - stresslet[1, 1]) / 2
        there = numpy.array([[added[2] * xx, added[0] * stresslet[0, 1]], [added[1] * stresslet[0, 1], added[3] * xx]])
    inside = turn @ (e + numpy.array([[0, -spin], [spin, 0]])) @ turn.T
    return inside, own[2]


def drop(axes, angle, ratio, times, box=None):
    """Returns the Taylor deformation in the plane and the inclination in degrees, accumulated over full turns, at times shear x t, of
    a drop without tension that is `ratio` times as viscous and starts with these axes, the first at `angle`; a rigid ellipsoid is one
    with a very large ratio. In a box, walls and images are included to leading order in size over distance."""
    added = images(box) if box is not None else numpy.zeros(4)
    c, s = numpy.cos(numpy.radians(angle)), numpy.sin(numpy.radians(angle))
    turn = numpy.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    shape, t, found = turn @ numpy.diag(numpy.square(axes)) @ turn.T, 0.0, []

    def rate(m):
        inside, across = flow_in(m, ratio, added)
        change = numpy.zeros((3, 3))
        change[:2, :2] = inside @ m[:2, :2] + m[:2, :2] @ inside.T
        change[2, 2] = 2 * across * m[2, 2]
        return change
    for until in times:
        steps = max(1, int(numpy.ceil((until - t) / .1)))
        dt = (until - t) / steps
        for _ in range(steps):
            shape = runge_kutta(rate, shape, dt)
        t = until
        squares, directions = numpy.linalg.eigh(shape[:2, :2])
        short, long = numpy.sqrt(squares)
        inclined = numpy.degrees(numpy.arctan2(directions[1, 1], directions[0, 1]))
        last = found[-1][1] if found else angle
        found.append(((long - short) / (long + short), inclined + 180 * numpy.round((last - inclined) / 180)))
    return numpy.array(found)
