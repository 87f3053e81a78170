"""What is known about rows that fail, and about limits, for the page: measured, not guessed."""

NOTES = {
    "F1": "classic: explicit Euler at a step that does not depend on the grid, .1 of 2 nu/U^2: its error, .003, does not fall.",
    "F6": "At Re = 1000 the errors fall at second order, .037, .0085, .0021 of the profiles at 64^2, 128^2, 256^2: 256^2 is needed.",
    "S1": "classic: B_xy at the interface does not converge (order 0, 47 % too large). The edge on the surface has the solid "
          "fraction 1/2 and takes the shear rate of both sides. Velocity and B_xy on the wall converge at first order. ACM "
          "and SMAC agree with `-acm_tolerance` 1e-7; with 1e-6 the order of u was lower with ACM.",
    "S3": "classic: in a steady state B_xy on the surface's edge can only be steady where du/dy = 0, so the first cell of "
          "fluid rests: the error there is 2 h/L_f (1 - h/(2 L_f)) = .0615 at 64 cells, which is what is measured, at first "
          "order, .98; twice the tolerance. The stress on that edge carries phi = 1/2, so that B_xy becomes twice the exact one: "
          "100 %, order 0. fast does not evolve B on such an edge.",
    "S4": "classic: the step, .0015, is set by the inertial limit whatever the grid, and its error, .4 to .8 %, does not fall.",
    "S6": "With density 1, that is rho gd R^2/mu = .05, inertia raises D by .9 % and turns the disc by .8 degrees at "
          "Ca = .1 (128 cells); the runs have density .1. Images 16 R away lower D by 1.6 %: the runs have a period of 32 R.",
    "S7": "The reference is the sum over the periodic box (scripts/validation/exact.py): 1.3783, 1.2877, 1.1689 in 20 R, and in a box "
          "of 10 R 1.3856, 1.2985, 1.1809, where 160^2 cells give 1.3855, 1.2985, 1.1810. Without inertia the flow "
          "should balance the stress from the start; a forced step delays the disc by about 1.4 of it, once. The automatic "
          "step therefore begins small and doubles (docs/method.md, section 8).",
    "S8": "Extrapolated with (R/L)^3 and h^2, 1.2, 1.4, .8 % are left at Ca = .05, .1, .2. The grids are too coarse for h^2 "
          "alone: at Ca = .1 the same fit without the runs of 6 cells per radius leaves .8 %, with a term in h^4 -.01 %. What is left "
          "should fall as h^4, so grids of 8 to 16 cells per radius in place of 6 to 12 would leave a third. Without "
          "extrapolation in h the error is about 2.0 (h/R)^2 at Ca = .1: 1 % needs 14 cells per radius. Inertia (density 1, "
          "rho gd R^2/mu = .05) raises D by .2 % and turns the sphere by .15 degrees (Ca = .1, 6 cells per radius, against density .1).",
    "S9": "Beside the mode s = -1.441313 +- 7.313910 i a disc that is let go excites the continuous spectrum of the viscous "
          "fluid: the same fit to the exact transient gives -1.47356 +- 7.34469 i, .6 % away. That is the reference. Our "
          "error is of first order or a little less: 3.3, 1.6, .9 % at 8, 16, 32 cells per radius; a box twice as large changes "
          "the rate by .1 %, half the time step by .01 %.",
    "R1": "Marching cubes of exact cell fractions do not converge: a sphere of 6, 12, 24 cells per radius gets -.9, +.1, "
          "+.3 % of surface too much.",
    "S12": "48 cells are halved to 3: levels with odd numbers of cells are not symmetric, so mirrored scenes agree to the "
           "tolerance of the sweeps instead of round-off; 64 cells give round-off. Recovery with classic: .006, .0036 of the "
           "walls' speed are left at 64^2, 128^2, first order or less, four times what is asked for; B in the smeared "
           "surface does not return to I.",
}
