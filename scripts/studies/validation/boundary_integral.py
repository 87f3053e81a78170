"""A capsule in unbounded Stokes shear u = y, viscosity 1 outside, by the boundary-integral method: a reference that shares nothing
with the program but the laws of the membrane.

Membrane: flat triangles with linear displacements, forces on nodes by virtual work. On the surface (Pozrikidis, Boundary
Integral and Singularity Methods for Linearized Viscous Flow, 1992), with the force F of the membrane, viscosity ratio l inside,
d = y - x,

    (1 + l)/2 u(x) = u_far(x) + 1/(8 pi) int G(d) F + (1 - l)/(8 pi) PV int u(y) T(d) n,   G = I/r + dd/r^3, T = -6 ddd/r^5.

Sums over nodes: of G as Hasimoto (J. Fluid Mech. 5, 1959) splits it, its smooth part between nodes, of the rest the integral over
the tangent plane; of T with int T n = -4 pi I subtracted, which leaves no singularity. Second order in the spacing."""
import dataclasses
import math

import numpy

from .ellipsoids import images
from .exact import pi

BLOCK = 64  # rows of pairs that stay in cache
REACH = 4.5  # of what is smoothed, in widths: there exp(-r^2) is 1e-9
WIDTH = .9  # of the smooth part, in spacings: what is below the spacing is 1e-3 of it


def tables():
    """Returns s1/r and s2/r^3 over r, in widths, of the smooth part s1 I/r + s2 dd/r^3 of G. Its Fourier transform is that of G times
    (1 + k^2/4) exp(-k^2/4), so that any forces supply energy to the flow. The integral of the rest over a plane is 2 sqrt(pi) (I -
    nn)."""
    r = numpy.linspace(0, REACH, 4000)[1:]
    error, bell = numpy.vectorize(math.erf)(r), 2 / math.sqrt(pi) * r * numpy.exp(-r * r)
    at_0 = 4 / math.sqrt(pi), 4 / 3 / math.sqrt(pi)
    return numpy.append(0, r), numpy.append(at_0[0], (error + bell) / r), numpy.append(at_0[1], (error - bell) / r**3)


TABLES = tables()


def sphere(halvings):
    """Returns nodes and outward triangles of an icosahedron whose edges are halved `halvings` times: 12, 42, 162, 642, 2562 nodes, on
    a sphere such that the polyhedron has the volume of a sphere of radius 1; its area and normals are then nearly correct, too."""
    golden = (1 + math.sqrt(5)) / 2
    rectangle = numpy.array([(0, a, b * golden) for a in (-1, 1) for b in (-1, 1)])
    x = numpy.concatenate([numpy.roll(rectangle, turn, axis=1) for turn in range(3)]) / math.hypot(1, golden)
    far = numpy.linalg.norm(x[:, None] - x, axis=2)
    edge = numpy.isclose(far, far[far > 0].min())
    triangles = numpy.array([(i, j, k) for i in range(12) for j in range(i) for k in range(j)
                             if edge[i, j] and edge[j, k] and edge[k, i]])
    inwards = numpy.linalg.det(x[triangles]) < 0
    triangles[inwards] = triangles[inwards][:, ::-1]
    for _ in range(halvings):
        edges = numpy.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]], axis=2).reshape(-1, 2)
        edges, which = numpy.unique(edges, axis=0, return_inverse=True)
        a, b, c = triangles.T
        ab, bc, ca = which.reshape(-1, 3).T + len(x)
        x = numpy.concatenate([x, x[edges].mean(axis=1)])
        x /= numpy.linalg.norm(x, axis=1)[:, None]
        quarters = (a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)
        triangles = numpy.concatenate([numpy.stack(corners, axis=1) for corners in quarters])
    return x * (4 / 3 * pi / moments(x, triangles)[0])**(1 / 3), triangles


def area_vectors(x, triangles):
    """Returns the area of every triangle times its normal."""
    a, b, c = (x[triangles[:, corner]] for corner in range(3))
    return numpy.cross(b - a, c - a) / 2


def to_nodes(parts, triangles, nodes):
    """Returns the sums over nodes of values at the corners of triangles, (triangles, 3, 3)."""
    return numpy.stack([numpy.bincount(triangles.ravel(), parts[..., d].ravel(), nodes) for d in range(3)], axis=1)


class Membrane:
    """The membrane of docs/method.md, (26), from its energy per undeformed area, with the Cauchy-Green tensor C of every triangle:
    `stress` is the second Piola-Kirchhoff stress 2 dW/dC."""

    def __init__(self, x, triangles, law, modulus, area_modulus=1):
        self.triangles, self.law, self.modulus, self.area_modulus = triangles, law, modulus, area_modulus
        a, b, c = (x[triangles[:, corner]] for corner in range(3))
        first = numpy.linalg.norm(b - a, axis=1)
        along = ((c - a) * (b - a)).sum(axis=1) / first
        twice = numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1)
        edges = numpy.stack([numpy.stack([first, along], axis=1), numpy.stack([0 * first, twice / first], axis=1)], axis=1)
        self.area, self.inverse = twice / 2, numpy.linalg.inv(edges)

    def stress(self, strain):
        trace, square = numpy.trace(strain, axis1=1, axis2=2)[:, None, None], numpy.linalg.det(strain)[:, None, None]
        inverse, one = numpy.linalg.inv(strain), numpy.eye(2)
        if self.law == "neo_hookean":  # W = G/2 (tr C + 1/det C - 3)
            return self.modulus * (one - inverse / square)
        # Skalak: W = G/4 (I1^2 + 2 I1 - 2 I2 + C I2^2), I1 = tr C - 2, I2 = det C - 1
        return self.modulus * ((trace - 1) * one + (self.area_modulus * (square - 1) - 1) * square * inverse)

    def forces(self, x):
        """Returns the forces on the fluid at the nodes: minus the derivative of the energy with respect to their positions."""
        a, b, c = (x[self.triangles[:, corner]] for corner in range(3))
        gradient = numpy.stack([b - a, c - a], axis=2) @ self.inverse
        of_edges = gradient @ self.stress(gradient.transpose(0, 2, 1) @ gradient) @ self.inverse.transpose(0, 2, 1)
        on_b, on_c = numpy.moveaxis(-self.area[:, None, None] * of_edges, 2, 0)
        return to_nodes(numpy.stack([-on_b - on_c, on_b, on_c], axis=1), self.triangles, len(x))


def blocks(x, width):
    """Yields rows of all pairs: (rows, d (3, rows, n), 1/r (0 at r = 0), index of near pairs, their r in widths)."""
    for first in range(0, len(x), BLOCK):
        rows = slice(first, min(first + BLOCK, len(x)))
        d = x.T[:, None, :] - x[rows].T[:, :, None]
        square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
        near = numpy.nonzero(square < (REACH * width)**2)
        distance = numpy.sqrt(square[near])
        square[numpy.arange(d.shape[1]), numpy.arange(rows.start, rows.stop)] = numpy.inf
        yield rows, d, 1 / numpy.sqrt(square), near, distance / width


def layers(x, forces, normals, double):
    """Returns the velocity of the single layer and, if `double`, the (3 n, 3 n) matrix of the sums over T n/(8 pi), with a diagonal
    such that a uniform u gives 0."""
    areas = numpy.linalg.norm(normals, axis=1)[:, None]
    width, unit = WIDTH * math.sqrt(areas.mean()), normals / areas
    single, matrix = numpy.empty_like(x), numpy.empty((3, len(x), 3, len(x))) if double else None
    for rows, d, inverse, near, distance in blocks(x, width):
        g1, g2 = inverse.copy(), inverse**3
        g1[near] = numpy.interp(distance, TABLES[0], TABLES[1]) / width
        g2[near] = numpy.interp(distance, TABLES[0], TABLES[2]) / width**3
        g2 *= d[0] * forces[:, 0] + d[1] * forces[:, 1] + d[2] * forces[:, 2]
        for i in range(3):
            single[rows, i] = (g1 @ forces[:, i] + numpy.einsum("rn,rn->r", g2, d[i])) / (8 * pi)
        if double:
            weight = -6 / (8 * pi) * inverse**5 * (d[0] * normals[:, 0] + d[1] * normals[:, 1] + d[2] * normals[:, 2])
            for i in range(3):
                of_row = weight * d[i]
                for j in range(i + 1):
                    matrix[i, rows, j] = matrix[j, rows, i] = of_row * d[j]
    single += width / (4 * math.sqrt(pi)) / areas * (forces - (forces * unit).sum(axis=1)[:, None] * unit)
    if double:
        diagonal = numpy.arange(len(x))
        for i in range(3):
            for j in range(3):
                matrix[i, diagonal, j, diagonal] -= matrix[i, :, j].sum(axis=1)
        matrix = matrix.reshape(3 * len(x), -1)
    return single, matrix


@dataclasses.dataclass
class Capsule:
    """A body in shear of rate 1 from t = 0, with radius 1 (or these nodes) when undeformed, without a membrane if capillary is inf.
    `box`: with the velocity gradient that walls at y = +-box[1]/2 and images in x and z add in the middle (ellipsoids.images)."""
    nodes: numpy.ndarray
    triangles: numpy.ndarray
    capillary: float
    law: str = "neo_hookean"
    ratio: float = 1
    box: tuple = None

    def __post_init__(self):
        self.membrane = Membrane(self.nodes, self.triangles, self.law, 1 / self.capillary)
        self.x, self.volume = self.nodes, moments(self.nodes, self.triangles)[0]
        self.u, self.added = numpy.zeros_like(self.x), numpy.zeros((3, 3))
        self.images = images(self.box) if self.box else None
        self.flux = 0  # largest part of the velocity that had to be taken out to keep the volume

    def velocity(self, x):
        normals = to_nodes(numpy.repeat(area_vectors(x, self.triangles)[:, None], 3, axis=1) / 3, self.triangles, len(x))
        forces = self.membrane.forces(x)
        single, matrix = layers(x, forces, normals, self.ratio != 1)
        for _ in range(2 if self.box else 1):
            far = numpy.array([[0, 1, 0], [0, 0, 0], [0, 0, 0]]) + self.added
            self.u = self.solved(x @ far.T + single, matrix)
            if self.box:
                self.added = self.of_images(x, forces, normals)
        areas = numpy.linalg.norm(normals, axis=1)
        outwards = (self.u * normals).sum() / areas.sum()
        self.flux = max(self.flux, abs(outwards))
        return self.u - outwards * normals / areas[:, None]

    def solved(self, right, matrix):
        """Solves u = right + (1 - ratio) D u, where D is the matrix with eigenvalues of 0 to 1, from the last u, by the iteration u =
        (right + (1 - ratio)(D - 1/2) u)/((1 + ratio)/2), whose error decreases by |1 - ratio|/(1 + ratio) each time."""
        if matrix is None:
            return right
        u, right = self.u.T.ravel(), right.T.ravel()
        for _ in range(200):
            last, u = u, 2 / (1 + self.ratio) * (right + (1 - self.ratio) * (numpy.einsum("rc,c->r", matrix, u) - u / 2))
            if abs(u - last).max() < 1e-7:
                return u.reshape(3, -1).T
        raise ArithmeticError("the velocity of the surface is not found")

    def of_images(self, x, forces, normals):
        """Returns the velocity gradient of the images, from the stresslet int -F x + (ratio - 1)(u n + n u)."""
        stresslet = -x.T @ forces + 2 * (self.ratio - 1) * self.u.T @ normals
        stresslet = (stresslet + stresslet.T) / 2
        xx = (stresslet[0, 0] - stresslet[1, 1]) / 2
        xy, yx, along, across = self.images * [stresslet[0, 1], stresslet[0, 1], xx, xx]
        return numpy.array([[along, xy, 0], [yx, across, 0], [0, 0, -along - across]])

    def step(self, dt):
        """Advances by dt with the third-order scheme of Shu and Osher."""
        x = self.x
        one = x + dt * self.velocity(x)
        two = .75 * x + .25 * (one + dt * self.velocity(one))
        self.x = x / 3 + 2 / 3 * (two + dt * self.velocity(two))
        self.x *= (self.volume / moments(self.x, self.triangles)[0])**(1 / 3)


def moments(x, triangles):
    """Returns the volume and its second moments, as sums over the tetrahedra of the triangles with the origin."""
    a, b, c = (x[triangles[:, corner]] for corner in range(3))
    volumes = (numpy.cross(a, b) * c).sum(axis=1) / 6
    outer = sum(numpy.einsum("t,ti,tj->ij", volumes, p, p) for p in (a, b, c, a + b + c)) / 20
    return volumes.sum(), outer


def shape(x, triangles):
    """Returns the Taylor deformation in the plane of the shear and the inclination in degrees of the ellipsoid with the same second
    moments, as in bodies.h5."""
    squares, directions = numpy.linalg.eigh(moments(x, triangles)[1][:2, :2])
    short, long = numpy.sqrt(squares)
    return (long - short) / (long + short), numpy.degrees(numpy.arctan(directions[1, 1] / directions[0, 1]))


def startup(capsule, times, dt):
    """Returns shape() at these times, (len(times), 2), computed with steps of at most dt."""
    t, found = 0.0, []
    for until in times:
        steps = math.ceil((until - t) / dt - 1e-9)
        for _ in range(steps):
            capsule.step((until - t) / steps)
        t = until
        found.append(shape(capsule.x, capsule.triangles))
    return numpy.array(found)


@dataclasses.dataclass(frozen=True)
class Startup:
    """A capsule in shear from rest, whose results are in tests/reference/NAME.csv."""
    law: str
    capillary: float
    ratio: float
    end: float
    interval = .25
    box = 8, 8, 6

    @property
    def name(self):
        return f"capsule_{self.law}_ca{self.capillary:g}_ratio{self.ratio:g}"

    @property
    def times(self):
        return numpy.arange(1, round(self.end / self.interval) + 1) * self.interval

    def shapes(self, halvings, box):
        capsule = Capsule(*sphere(halvings), self.capillary, self.law, self.ratio, self.box if box else None)
        # Stable on a fine membrane, whose short waves relax at a rate of 1/(1 + ratio) and the inverse spacing.
        found = startup(capsule, self.times, min(.1, .8 / 2**halvings) * self.capillary * (1 + self.ratio) / 2)
        return found, capsule.flux


STARTUPS = (Startup("neo_hookean", .15, 1, 2), Startup("neo_hookean", .3, 1, 3), Startup("skalak", .3, 1, 3), Startup("skalak", .6, 1, 3),
            Startup("neo_hookean", .15, 5, 4.5), Startup("skalak", .3, 5, 4.5), Startup("neo_hookean", .3, .2, 2.25))


def extrapolated(coarse, fine):
    """Returns the limit of two results with errors of second order in the spacing; the spacing of the fine mesh is half that of the
    coarse one."""
    return fine + (fine - coarse) / 3
