"""Notes on cases for the pages of docs/validation: known misses, limits, and what a reader needs to judge the rows. Measured values only."""

NOTES = {
    "F1": ("`classic` uses explicit Euler with a step that does not depend on the grid, .1 of 2 nu/U^2. Its error, .003, therefore does not decrease with the spacing.",),
    "F6": ("At Re = 1000 the errors of the profiles decrease at second order, from .037 at 64^2 and .0085 at 128^2 to .0021 at 256^2. The tolerance is met at 256^2.",),
    "S1": ("With `classic`, B_xy at the interface does not converge: it is 47 % too large on all grids. The edge on the interface has the solid fraction 1/2 and the mean shear rate "
           "of solid and fluid. The velocity, and B_xy on the wall, converge at first order.",),
    "S3": ("With `classic`, B_xy on the edge at the interface can be steady only where du/dy = 0. Therefore the first cell of fluid is at rest, with an error of u of "
           "2 h/L_f (1 - h/(2 L_f)) = .0615 at 64 cells, as measured, of first order.",
           "The stress on that edge is weighted with phi = 1/2, so that B_xy becomes twice the exact value there, on any grid. `fast` does not evolve B on such an edge.",),
    "S4": ("With `classic`, the inertial limit sets the step, .0015, on all grids. Its error, .4 to .8 %, does not decrease with the spacing.",),
    "S6": ("The reference neglects inertia and periodic images. The runs keep both small: the density is .1, so that rho (shear rate) R^2/mu = .005, and the period is 32 R.",),
    "S7": ("The reference is a sum over the periodic box (scripts/studies/validation/exact.py). With 20 R it gives 1.3783, 1.2877 and 1.1689.",
           "Without inertia the flow balances the stress from the start. A constant step delays the disc once by about a step; therefore the automatic step begins small and grows "
           "(docs/method.md, section 8).",),
    "S8": ("Results are extrapolated with (R/L)^3 in the size of the box, and with h^2 from 8 to 12 or 16 cells per radius.",
           "Without extrapolation in h the error is (h/R)^2 times the coefficient in the table, so that 1 % needs 8, 16 and 20 cells per radius at Ca = .2, .1 and .05.",),
    "S9": ("Besides the mode s = -1.441313 +- 7.313910 i, a released disc excites the continuous spectrum of the viscous fluid. The whole curve D(t) is compared, because a fitted rate "
           "would depend on the interval of the fit.",
           "The observed order is one or slightly less.",),
    "R1": ("Marching cubes of exact cell fractions do not converge: an error of some tenths of a per cent of the surface remains on any grid.",),
    "S12": ("A grid of 48 cells is halved until 3 remain. Levels with an odd number of cells are not symmetric, so that mirrored scenes agree to the tolerance of the pressure iterations; "
            "with 64 cells they agree to round-off.",
            "Recovery with `classic`: .006 and .0036 of the speed of the walls remain at 64^2 and 128^2, up to four times the tolerance, and decrease at first order or less, because B "
            "in the smeared surface does not return to I.",),
    "S11": ("A grid of 20 cells has 8 cells per radius.",),
    "V6": ("All runs have 23 cells per diameter and end after 4 ms.",
           "Axial diameters are within .35 um of the experiment. Transverse diameters are above it, at 19, 47 and 88 pN by .2 um more than the error bar.",
           "The grid is not the cause: at 47 pN after 3 ms, the diameters are 10.86 and 6.69 um with a spacing of .25 um, 10.83 and 6.70 with .33 um, and 10.84 and 6.70 without bending.",
           "A cell that is as wide as that of the experiment at 0 pN, 7.69 um instead of 7.82, is .11 um narrower at 47 pN.",
           "The modulus of area, a thousandth of a real one, allows the area to grow by up to 9.0 %.",),
    "L1": ("The box has two walls and a period of 8 R. The reference is Richardson's extrapolation from 8, 16 and 32 cells per radius with two treatments of the surface; it is known to .5 %.",
           "The exact transient of S6 gives .3995; it treats walls and images as those of a point and neglects terms of the size (7.74/64)^2, 1.5 %.",
           "The drift is judged without a reference, since the exact D is steady.",),
    "L2": ("Both runs have the same grid; each chooses its own time step.",),
    "L3": ("D is compared as a vector, D e^(2 i theta), because at 45 degrees D alone would not show an error of the angle.",),
    "L4": ("Along the grid, with surfaces on faces, the fast method is of second order, which also checks the reference. At 45 degrees, with hx different from hy, the surfaces cut the "
           "cells in all ways.",),
    "V2": ("Walls and images add a strain, computed from the stresslet of the drop (scripts/studies/validation/ellipsoids.py).",
           "Without tension a drop remains an ellipsoid at all times, so that the reference is exact.",),
    "V4": ("The effect of walls and images is that of a rigid sphere, since the membrane rotates like one.",),
    "V5": ("The reference of the start-up includes the effect of walls and images on D, computed by scripts/studies/validation/capsule_startups. For the long run, in a box of 5, 6 and "
           "5 radii, they add .8 % to the strain rate and reduce the vorticity by 2.8 % (scripts/studies/validation/ellipsoids.py).",),
    "V9": ("The references include walls and images of the box to leading order in size over distance, which adds some 2 % to D.",
           "They agree with the reference of V5, which is from another code, to .1 %, and without a membrane with exact ellipsoids (tests/regression/test_boundary_integral.py).",),
}
