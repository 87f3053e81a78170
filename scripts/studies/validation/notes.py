"""Known misses and limits of cases, for the page: measured values only."""

NOTES = {
    "F1": "classic: explicit Euler with a step that does not depend on the grid, .1 of 2 nu/U^2. Its error, .003, does not decrease with the spacing.",
    "F6": "At Re = 1000 the errors of the profiles decrease at second order: .037, .0085 and .0021 at 64^2, 128^2 and 256^2. So 256^2 is needed.",
    "S1": "classic: B_xy at the interface does not converge (order 0, 47 % too large). The edge on the surface has the solid fraction 1/2 and takes the shear rate of "
          "both sides. Velocity, and B_xy on the wall, converge at first order.",
    "S3": "classic: in a steady state B_xy on the edge at the surface can be steady only where du/dy = 0, so that the first cell of fluid is at rest. The error there is "
          "2 h/L_f (1 - h/(2 L_f)) = .0615 at 64 cells, as measured, at first order (.98). The stress on that edge has phi = 1/2, so that B_xy becomes twice the exact value: "
          "100 %, order 0. fast does not evolve B on such an edge.",
    "S4": "classic: the step, .0015, is set by the inertial limit on all grids. Its error, .4 to .8 %, does not decrease with the spacing.",
    "S6": "The reference neglects inertia and images: the runs have density .1, rho gd R^2/mu = .005, and a period of 32 R.",
    "S7": "The reference is the sum over the periodic box (scripts/studies/validation/exact.py): 1.3783, 1.2877, 1.1689 in 20 R. Without inertia the flow should balance the "
          "stress from the start. A constant step delays the disc once by about a step; therefore the automatic step begins small and doubles (docs/method.md, section 8).",
    "S8": "Results are extrapolated with (R/L)^3, and with h^2 from 8 to 12 or 16 cells per radius. Without extrapolation in h the error is (h/R)^2 times the coefficient in "
          "the table, so that 1 % needs 8, 16 and 20 cells per radius at Ca = .2, .1 and .05.",
    "S9": "The reference is D(t) of the exact transient (tests/reference/ringing_disc.csv). Besides the mode s = -1.441313 +- 7.313910 i, a released disc excites the continuous "
          "spectrum of the viscous fluid, so that a fitted rate would depend on its window. The observed order is one or slightly less.",
    "R1": "Marching cubes of exact cell fractions do not converge: an error of some tenths of a per cent of the surface remains on any grid.",
    "S12": "48 cells are halved to 3. Levels with an odd number of cells are not symmetric, so that mirrored scenes agree to the tolerance of the pressure iterations instead of "
           "round-off; 64 cells agree to round-off. Recovery with classic: .006 and .0036 of the walls' speed remain at 64^2 and 128^2, first order or less, four times the "
           "tolerance; B in the smeared surface does not return to I.",
    "S11": "The exact solution has a wall at rest. 20 cells are 8 per radius.",
    "V6": "\"at\" lists the forces in pN; all runs have 23 cells per diameter and end after 4 ms. Axial diameters are within .38 um of the experiment. Transverse diameters are above "
          "it, at 19, 47 and 88 pN by .2 um more than the error bar. The grid is not the cause: at 47 pN after 3 ms a spacing of .25 um gives 10.86 and 6.69 um, .33 um gives 10.83 "
          "and 6.70, and without bending the diameters are 10.84 and 6.70. A cell that is as wide as the experiment's at 0 pN, 7.69 um instead of 7.82, is .11 um narrower at "
          "47 pN. The modulus of area, a thousandth of a real one, allows the area to grow by up to 9.5 %.",
    "L1": "In L1, L2, L3 and the long S6, \"at\" is cells per radius. The box has two walls and a period of 8 R. The reference is Richardson's extrapolation from 8, 16 and 32 cells "
          "per radius with two treatments of the surface, known to .5 %. The transient of S6 with images of a point (scripts/studies/validation/exact.py) gives .3995; it "
          "neglects (7.74/64)^2, 1.5 %. A steady D needs no reference.",
    "L2": "Exact by Galilean invariance. Both runs have the same grid; each chooses its own step.",
    "L3": "Exact: nothing deforms in a uniform flow. D is taken as a vector, D e^(2 i theta), because at 45 degrees D alone would count a gain.",
    "L4": "Exact (scripts/studies/validation/exact.py): shear along layers is linear at any amplitude. Along the cells, with surfaces on faces, the fast method is of second order, "
          "which also checks the reference. At 45 degrees the surfaces cut the cells in all ways, with hx != hy.",
    "V2": "Walls and images add strain by the stresslet of the drop (ellipsoids.py). Without tension a drop remains an ellipsoid.",
    "V4": "Walls and images are those of a rigid sphere, since the membrane turns like one.",
    "V5": "The reference of the start-up includes the effect of walls and images of its box on D, by capsule_startups. Later, in a box of 5, 6 and 5 radii, they add .8 % to the "
          "strain rate and reduce the vorticity by 2.8 % (ellipsoids.py).",
    "V9": "The references include the walls and images of the box, to leading order in size over distance; they add some 2 % to D. They agree with that of V5, from another code, to "
          ".1 %, and without a membrane with exact ellipsoids (tests/regression/test_boundary_integral.py).",
}
