"""What is known about rows that fail, and about limits, for the page: measured, not guessed."""

NOTES = {
    "F1": "classic: explicit Euler at a step that does not depend on the grid, .1 of 2 nu/U^2: its error, .003, does not fall.",
    "F6": "At Re = 1000 the errors fall at second order, .037, .0085, .0021 of the profiles at 64^2, 128^2, 256^2: 256^2 is needed.",
    "S1": "classic: B_xy at the interface does not converge (order 0, 47 % too large). The edge on the surface has the solid "
          "fraction 1/2 and takes the shear rate of both sides. Velocity and B_xy on the wall converge at first order.",
    "S3": "classic: in a steady state B_xy on the surface's edge can only be steady where du/dy = 0, so the first cell of "
          "fluid rests: the error there is 2 h/L_f (1 - h/(2 L_f)) = .0615 at 64 cells, which is what is measured, at first "
          "order, .98. The stress on that edge carries phi = 1/2, so that B_xy becomes twice the exact one: 100 %, order 0. fast does not evolve B on such an edge.",
    "S4": "classic: the step, .0015, is set by the inertial limit whatever the grid, and its error, .4 to .8 %, does not fall.",
    "S6": "The reference knows neither inertia nor images: the runs have density .1, rho gd R^2/mu = .005, and a period "
          "of 32 R.",
    "S7": "The reference is the sum over the periodic box (scripts/studies/validation/exact.py), 1.3783, 1.2877, 1.1689 in 20 R. Without "
          "inertia the flow should balance the stress from the start; a forced step delays the disc by about a step, once. "
          "The automatic step therefore begins small and doubles (docs/method.md, section 8).",
    "S8": "Extrapolated with (R/L)^3 and h^2 from 8 to 12 or 16 cells per radius. Without extrapolation in h the error is (h/R)^2 "
          "times the coefficient in the table, so that 1 % needs 8, 16 and 20 cells per radius at Ca = .2, .1 and .05.",
    "S9": "The reference is D(t) of the exact transient (tests/reference/ringing_disc.csv): beside the mode s = -1.441313 +- "
          "7.313910 i a disc that is let go excites the continuous spectrum of the viscous fluid, so that a fitted rate "
          "depends on its window. Our error is of first order or a little less.",
    "R1": "Marching cubes of exact cell fractions do not converge: some tenths of a per cent of surface are left on any "
          "grid.",
    "S12": "48 cells are halved to 3: levels with odd numbers of cells are not symmetric, so mirrored scenes agree to the "
           "tolerance of the sweeps instead of round-off; 64 cells give round-off. Recovery with classic: .006, .0036 of the "
           "walls' speed are left at 64^2, 128^2, first order or less, four times what is asked for; B in the smeared "
           "surface does not return to I.",
    "S11": "The exact solution has a wall at rest. 20 cells are 8 per radius.",
    "V6": "\"at\" are the forces in pN, all at 23 cells per diameter after 4 ms. Axial diameters lie within .33 um of the experiment's. The "
          "transverse ones lie above it, at 19, 47 and 88 pN by .2 um more than its error. It is not the grid: at 47 pN after 3 ms a spacing of .25 "
          "um gives 10.86 and 6.69 um, .33 um 10.83 and 6.70, and without bending 10.84 and 6.70. A cell that is as wide as the experiment's at 0 pN, 7.69 um instead of 7.82, "
          "is .11 um narrower at 47 pN. The modulus of area, a thousandth of a real one, leaves a change of area of 1.4 % at 88 pN and of 4 % at 192 pN.",
    "L1": "In L1, L2, L3 and the long S6 \"at\" is cells per radius. Both walls and period 8 R. The reference is "
          "Richardson's extrapolation from 8, 16 and 32 cells per radius by two treatments of the surface, known to .5 %; the transient of S6 with images of a "
          "point (scripts/studies/validation/exact.py) gives .3995: it neglects (7.74/64)^2, 1.5 %. A steady D needs no reference.",
    "L2": "Exact: Galilean invariance. Both runs are of the same grid and step by themselves.",
    "L3": "Exact: nothing deforms in a uniform flow. D as a vector, D e^(2 i theta): at 45 degrees D alone would count a gain.",
    "L4": "Exact (scripts/studies/validation/exact.py): shear along layers is linear at any amplitude. Along the cells, surfaces on faces, "
          "the fast method is of second order, which checks the reference too. At 45 degrees the surfaces "
          "cut the cells, hx != hy, in all ways.",
    "V2": "Walls and images add strain by the stresslet of the drop (ellipsoids.py). Without tension a drop stays an ellipsoid.",
    "V4": "Walls and images as for a rigid sphere, as which the membrane turns.",
    "V5": "The start-up has what walls and images do to D in its box, by capsule_startups. Later, in a box of 5, 6 and 5 radii, they add .8 % to the "
          "strain rate and take 2.8 % off the vorticity (ellipsoids.py).",
    "V9": "The references are between the walls and images of the box, to leading order in size over distance; they add some 2 % to D. They agree with that of "
          "V5, another code, to .1 %, and without a membrane with exact ellipsoids (tests/regression/test_boundary_integral.py).",
}
