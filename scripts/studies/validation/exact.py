"""Exact solutions, each with its source. Density 1; lengths, times and stresses in any consistent units."""
import cmath
import math

import numpy

pi = math.pi


def taylor_green(x, y, t, nu, mean):
    """Returns u of the advected vortices in the unit box (Taylor & Green 1937, with a Galilean transformation), k = 2 pi."""
    k = 2 * pi
    return mean + math.exp(-2 * nu * k * k * t) * numpy.sin(k * (x - mean * t)) * numpy.cos(k * (y - mean * t))


def channel_startup(y, t, g, height, nu):
    """Returns u between plates under a force from t = 0: the parabola less its Fourier series (Batchelor 1967, section 4.3)."""
    m = numpy.arange(1, 400, 2)[:, None] * pi
    decay = 4 * g * height**2 / (nu * m**3) * numpy.sin(m * y / height) * numpy.exp(-nu * (m / height)**2 * t)
    return g * y * (height - y) / (2 * nu) - decay.sum(axis=0)


def duct_startup(t, g, side, nu):
    """Returns u in the middle of a square duct under a force from t = 0, by the double Fourier series."""
    m = numpy.arange(1, 200, 2)
    m, n = numpy.meshgrid(m, m)
    decay = nu * pi**2 * (m * m + n * n) / side**2
    sign = numpy.where((m + n) % 4 == 2, 1, -1)
    return numpy.array([(16 * g / (pi**2 * m * n * decay) * sign * -numpy.expm1(-decay * x)).sum() for x in numpy.atleast_1d(t)])


def womersley(y, t, force, omega, height, nu):
    """Returns u between plates under the force cos(omega t) in the periodic state (Womersley 1955, plane)."""
    k = cmath.sqrt(1j * omega / nu)
    shape = 1 - numpy.cosh(k * (y - height / 2)) / cmath.cosh(k * height / 2)
    return (force / (1j * omega) * shape * cmath.exp(1j * omega * t)).real


def oscillating_wall(y, t, speed, omega, height, nu):
    """Returns u over a plate at rest, with an upper plate of speed sin(omega t), in the periodic state (Stokes 1851, with two
    plates)."""
    k = cmath.sqrt(1j * omega / nu)
    return (speed * numpy.sinh(k * y) / cmath.sinh(k * height) * cmath.exp(1j * omega * t)).imag


class Layers:
    """A solid layer 0 < y < 1/2 under fluid up to y = 1, with an upper wall of speed V sin(omega t), in the periodic state. Both
    layers obey linear equations at any amplitude: u = Im{uh(y) e^{i omega t}} (set-up of Sugiyama et al., J. Comput. Phys. 230,
    2011)."""

    def __init__(self, mu=1.0, modulus=5.0, speed=1.0, omega=pi, half=0.5):
        self.omega, self.half = omega, half
        ms = mu + modulus / (1j * omega)
        self.ks, self.kf = cmath.sqrt(1j * omega / ms), cmath.sqrt(1j * omega / mu)
        ratio = ms * self.ks / (mu * self.kf)
        self.a = speed / (cmath.cosh(self.kf * half) * cmath.sinh(self.ks * half)
                          + ratio * cmath.cosh(self.ks * half) * cmath.sinh(self.kf * half))
        self.b, self.c = ratio * self.a * cmath.cosh(self.ks * half), self.a * cmath.sinh(self.ks * half)

    def amplitude(self, y):
        """Returns the complex amplitude of u."""
        y = numpy.asarray(y)
        above = y - self.half
        fluid = self.b * numpy.sinh(self.kf * above) + self.c * numpy.cosh(self.kf * above)
        return numpy.where(y < self.half, self.a * numpy.sinh(self.ks * y), fluid)

    def shear_amplitude(self, y):
        """Returns |B_xy| in the solid."""
        return abs(self.a * self.ks * numpy.cosh(self.ks * y) / (1j * self.omega))


class TurnedLayers:
    """An infinite sequence of alternating solid and fluid layers, each of thickness `half`, in the slowest mode that is odd about
    their middles: w = Re(f(eta) e^{s t}) along them, with eta the distance from the middle of a solid layer, and gamma = Re(f' e^{s
    t}/s) the shear of the solid. As in S1 the equations are linear at any amplitude. `strain` is |f'/s| at the surface."""

    def __init__(self, half, mu, modulus, strain, guess):
        def parts(s):
            ms = mu + modulus / s
            ks, kf = cmath.sqrt(s / ms), cmath.sqrt(s / mu)
            # a sinh(ks h/2) + b sinh(kf h/2) = 0, ms a ks cosh(ks h/2) = mu b kf cosh(kf h/2)
            return ks, kf, (ms * ks * cmath.cosh(ks * half / 2) * cmath.sinh(kf * half / 2)
                            + mu * kf * cmath.cosh(kf * half / 2) * cmath.sinh(ks * half / 2))
        s = guess
        for _ in range(50):  # Newton
            step = parts(s)[2] / ((parts(s + 1e-6)[2] - parts(s - 1e-6)[2]) / 2e-6)
            s -= step
        self.half, self.s, (self.ks, self.kf, self.left) = half, s, parts(s)
        self.a = strain * s / (self.ks * cmath.cosh(self.ks * half / 2))
        self.b = -self.a * cmath.sinh(self.ks * half / 2) / cmath.sinh(self.kf * half / 2)

    def wrapped(self, eta):
        """Returns the signed distances from the nearest middle of a solid layer and from the nearest middle of a fluid layer."""
        period = 2 * self.half
        solid = eta - period * numpy.round(eta / period)
        return solid, eta - self.half - period * numpy.round((eta - self.half) / period)

    def velocity(self, eta, t):
        solid, fluid = self.wrapped(eta)
        f = numpy.where(numpy.abs(solid) < self.half / 2, self.a * numpy.sinh(self.ks * solid),
                        self.b * numpy.sinh(self.kf * fluid))
        return (f * numpy.exp(self.s * t)).real

    def shear(self, eta, t):
        """Returns gamma; beyond the surface its value on the surface."""
        solid = numpy.clip(self.wrapped(eta)[0], -self.half / 2, self.half / 2)
        return (self.a * self.ks * numpy.cosh(self.ks * solid) / self.s * numpy.exp(self.s * t)).real


def resting_layers(y, force, mu, half=0.5, height=1.0):
    """Returns u of fluid over a solid layer at rest under a body force: a parabola above y = half."""
    return numpy.where(y > half, force * (y - half) * (height - y) / (2 * mu), 0)


def shear_wave(t, start, mu=0.01, modulus=1.0, k=2 * pi):
    """Returns V of u = V(t) sin ky in a box of solid with B = I at t = 0: s^2 + mu k^2 s + G k^2 = 0, exact at any amplitude."""
    decay = mu * k * k / 2
    omega = math.sqrt(modulus * k * k - decay**2)
    return start * numpy.exp(-decay * t) * (numpy.cos(omega * t) - decay / omega * numpy.sin(omega * t))


def disc_in_shear(capillary):
    """Returns the Taylor deformation and the inclination (degrees) of a disc in unbounded Stokes shear. The flow inside is affine
    (Eshelby), so that Ca = D (1 + D^2)/(1 - D^2), cos 2 theta = 2 D/(1 + D^2)."""
    low, high = 0.0, 0.9
    while high - low > 1e-15:
        d = (low + high) / 2
        low, high = (d, high) if d * (1 + d * d) / (1 - d * d) < capillary else (low, d)
        if d in (low, high) and high - low < 1e-14:
            break
    return low, math.degrees(math.acos(2 * low / (1 + low * low)) / 2)


def bessel_j1(x):
    """Returns J_1, interpolated linearly in a table of spacing .005, with an error of 2e-6 for 0 <= x <= 100."""
    nodes, angle = numpy.linspace(0, 100, 20001), 2 * pi * numpy.arange(256) / 256
    values = numpy.concatenate([numpy.cos(angle - part[:, None] * numpy.sin(angle)).mean(axis=1)
                                for part in numpy.array_split(nodes, 20)])
    return numpy.interp(x, nodes, values)


def ellipse_mobility(stretch, box, cut=60.0):
    """Returns -mu/tau times the strain rate that a uniform stress diag(tau, -tau) in an ellipse causes, averaged over this ellipse
    with semi-axes l and 1/l in a periodic Stokes fluid (a square box): the sum over k of |chi|^2/(A_box A) 2 kx^2 ky^2/k^4, with chi
    the transform of the ellipse. k = 0 is excluded, since the box as a whole does not stretch. Weights beyond the cut are treated as
    in an unbounded fluid, where the sum is 1/(4 cosh^2 ln l)."""
    k = 2 * pi / box * numpy.arange(-math.ceil(cut * stretch * box / (2 * pi)), math.ceil(cut * stretch * box / (2 * pi)) + 1)
    kx, ky = numpy.meshgrid(k, k, indexing="ij")
    q = numpy.hypot(kx * stretch, ky / stretch)
    here = (q > 0) & (q <= cut)
    kx, ky, q = kx[here], ky[here], q[here]
    weight = (2 * pi * bessel_j1(q) / q)**2 / (box**2 * pi)
    missing = 1 - weight.sum() - pi / box**2  # Parseval, less k = 0
    return float((weight * 2 * (kx * ky)**2 / (kx**2 + ky**2)**2).sum() + missing / (4 * math.cosh(math.log(stretch))**2))


def relaxing_disc(stretch, box, times):
    """Returns the stretch of a disc of radius 1 with B = diag(l^2, l^-2) that is released in a periodic Stokes fluid, at times G t/mu.
    It stays an ellipse: ds/dt = -G sinh(2s)/mu times the mobility, s = ln l. Unbounded: sinh s ~ exp(-G t/(2 mu))."""
    nodes = numpy.linspace(0, math.log(stretch), 7)
    factor = numpy.polyfit(nodes, [ellipse_mobility(math.exp(s), box) * 4 * math.cosh(s)**2 for s in nodes], 3)

    def rate(s):
        return -math.tanh(s) / 2 * float(numpy.polyval(factor, s))
    s, t, found = math.log(stretch), 0.0, []
    for until in times:
        steps = max(1, round((until - t) / 0.01))
        dt = (until - t) / steps
        for _ in range(steps):
            middle = rate(s + dt / 2 * rate(s))
            s += dt * middle
        t = until
        found.append(math.exp(s))
    return found


def added_by_walls(k, b):
    """Returns the contribution of walls at y = +-b to L_xy, L_yx of tau_xy and L_xx of tau_xx in images_of_disc, for each wave number
    k."""
    c, s, e = numpy.cosh(k * b), numpy.sinh(k * b), numpy.exp(-k * b)

    def added(f, g):
        """Returns alpha, beta such that alpha f + beta g cancels b e^{-kb}/2 and its slope at y = b; f, g: (value, slope) there."""
        value, slope = b * e / 2, (1 - k * b) * e / 2
        determinant = f[0] * g[1] - f[1] * g[0]
        return (value * g[1] - slope * g[0]) / determinant, (slope * f[0] - value * f[1]) / determinant
    odd, even = added((c, k * s), (b * s, s + b * k * c)), added((s, k * c), (b * c, c + b * k * s))  # cosh, y sinh; sinh, y cosh
    return odd[0] * k * k + 2 * odd[1] * k, odd[0] * k * k, k * (even[0] * k + even[1])


def images_of_disc(height, length):
    """Returns the velocity gradient that walls and images add in the middle of a channel, periodic after `length`, where a body of
    unit area has the deviatoric stress tau, viscosity 1: (L_xy, L_yx) of tau_xy and L_xx = -L_yy of tau_xx. The streamfunction is that
    of a force dipole in Stokes flow: for each k the free one, -|y| e^{-k|y|}/2 or i y e^{-k|y|}/2, plus the contribution of the
    walls."""
    k = 2 * pi / length * numpy.arange(1, math.ceil(20 * length / height) + 1)
    xy, yx, xx = (part.sum() for part in added_by_walls(k, height / 2))
    # k = 0, and sums less integrals of the free part: sum of n is -1/12.
    return (2 / length * xy + 1 / (length * height) - pi / (3 * length**2), 2 / length * yx,
            2 / length * xx + pi / (6 * length**2))


def runge_kutta(rate, x, dt):
    """Returns x after dt for dx/dt = rate(x), by the classical scheme of fourth order."""
    k1 = rate(x)
    k2 = rate(x + dt / 2 * k1)
    k3 = rate(x + dt / 2 * k2)
    return x + dt / 6 * (k1 + 2 * k2 + 2 * k3 + rate(x + dt * k3))


def sheared_disc(capillary, times, height=math.inf, length=math.inf):
    """Returns the Taylor deformation and B (xx, xy, yy), at times (shear rate x t), of a disc of radius 1, with viscosity and shear
    rate 1 and modulus 1/Ca, that is put at rest into Stokes shear. It stays an ellipse with uniform B (Eshelby): B' = L B + B L^T,
    where L is the sum of the gradient of the flow and of -G/(2 mu) (B - tr/2)/(1 + tr/2) of the disc. Walls at `height` and images at
    `length` add to L as for a point-like body; the square of 7.74/height^2 is neglected."""
    xy, yx, xx = images_of_disc(height, length) if height < math.inf else (0, 0, 0)

    def rate(b):
        a, c = (b[0] - b[2]) / 2, b[1]  # deviator
        own, area = 1 / (2 * capillary * (1 + (b[0] + b[2]) / 2)), pi / capillary
        lxx, lxy, lyx = (area * xx - own) * a, 1 + (area * xy - own) * c, (area * yx - own) * c
        return numpy.array([2 * (lxx * b[0] + lxy * b[1]), lxy * b[2] + lyx * b[0], 2 * (lyx * b[1] - lxx * b[2])])
    b, t, found = numpy.array([1.0, 0.0, 1.0]), 0.0, []
    for until in times:
        steps = max(1, math.ceil((until - t) / min(0.02, capillary / 5)))
        dt = (until - t) / steps
        for _ in range(steps):
            b = runge_kutta(rate, b, dt)
        t = until
        found.append((stretch_deformation(*b), *b))
    return numpy.array(found)


def stretch_deformation(xx, xy, yy):
    """Returns the Taylor deformation (r - 1)/(r + 1) of the ellipse that a circle with this B becomes; r^2 is the ratio of its
    principal values."""
    middle, radius = (xx + yy) / 2, numpy.hypot((xx - yy) / 2, xy)
    r = numpy.sqrt((middle + radius) / (middle - radius))
    return (r - 1) / (r + 1)


def sheared_circle(strain):
    """Returns the Taylor deformation of a circle after simple shear: principal stretches e^{+-s}, sinh s = strain/2."""
    return math.tanh(math.asinh(strain / 2))


def red_cell_thickness(r, diameter=8.0):
    """Returns the thickness of a red cell at the distance r from its axis (Evans & Fung, Microvasc. Res. 4, 1972)."""
    q = numpy.clip(2 * r / diameter, 0, 1)
    return diameter / 2 * numpy.sqrt(1 - q**2) * (0.207161 + 2.002558 * q**2 - 1.122762 * q**4)
