"""What is known about rows that fail, for the page: measured, not guessed."""

NOTES = {
    "F6": "At Re = 1000 the errors fall at second order, .018, .0045 at 64^2, 128^2: 128^2 is too coarse for this "
          "tolerance, 256^2 is what the order asks for (.0011).",
    "S1": "classic: B_xy at the interface does not converge. Its interface is a layer in which B takes the shear rate of "
          "both sides; the velocity and B_xy on the wall do converge. The order of fast with ACM suffers from "
          "`-acm_tolerance`: with SMAC it is 2.00.",
    "S6": "With density 1, that is rho gd R^2/mu = .05, inertia raises D by .9 % and turns the disc by .8 degrees at "
          "Ca = .1 (128 cells); the runs have density .1. Images 16 R away lower D by 1.6 %: the runs have a period of 32 R.",
    "S7": "Without inertia the flow should balance the stress from the start; a forced step delays the disc by about 1.4 of "
          "it, once: l at G t/mu = .5 on 160^2 is 1.3898, 1.3823, 1.3773 with steps of 5.3, 2, .5, with ACM and SMAC "
          "alike. The automatic step therefore begins small and doubles (docs/method.md, section 8). In space the order "
          "is 1.",
    "S8": "At Ca = .1 D is .13512, .13239, .13223 with 6, 6, 8 cells per radius in boxes of 6, 8, 6 radii: extrapolated with "
          "(R/L)^3 and h^2 .1238, 1.8 % above the exact .12164. Two boxes at 6 cells per radius alone give .1304: "
          "resolution counts for more than the box.",
    "S9": "First order in space: 2.8, 1.2, .6 % at 8, 16, 32 cells per radius; a box twice as large changes the rate by "
          ".1 %, half the time step by .01 %.",
    "S12": "48 cells are halved to 3: levels with odd numbers of cells are not symmetric, so mirrored scenes agree to the "
           "tolerance of the sweeps instead of round-off; 64 cells give round-off. Recovery with classic at 64^2: .006 of "
           "the walls' speed is left, six times the tolerance (fast: .0006).",
}
