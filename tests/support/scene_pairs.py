"""Small scenes that together contain every pair of features that the program accepts beside each other.

A feature has several values, each a list of options. Candidates with random values are checked by the program itself
(-check_only, all in one start); from those that it accepts, scenes are chosen one by one so that each contains as many
pairs of values that no scene before it has as possible, until every pair that occurs in any candidate is covered.
"""
import itertools
import pathlib
import random

ROOT = pathlib.Path(__file__).resolve().parents[2]
FLAT, DEEP = "-grid_cells 36,21,1 -grid_length 3.6,2.1,.1", "-grid_cells 18,13,12 -grid_length 3.6,2.6,2.4"
BALL = "-cell_shape sphere -cell_radius .5"
FEATURES = {
    "dimension": {"2-D": FLAT, "3-D": DEEP},
    "method": {
        "fast": "", "classic": "-method classic", "explicit": "-viscous_scheme explicit",
        "constant force": "-elastic_force constant", "weno5": "-interface_scheme weno5",
        "identity": "-solid_exterior identity"},
    "pressure": {"acm": "", "plain sweeps": "-acm_coarse false -acm_search_directions 0 -acm_iterations_max 4", "smac": "-pressure_solver smac"},
    "x": {"periodic": "", "walls": "-boundary_x wall",
          "inflow, outflow": "-boundary_xmin inflow -boundary_xmax outflow -boundary_xmin_velocity .2 -boundary_xmin_angular_frequency 3",
          "inflow, load": "-boundary_xmin inflow -boundary_xmax pressure -boundary_xmin_flow_rate .3 -boundary_xmin_profile "
                          "developed -boundary_xmax_windkessel 1,.2,3",
          "feeder": "-boundary_xmin inflow -boundary_xmax outflow -boundary_xmin_velocity .3 -boundary_xmin_profile developed "
                    "-boundary_xmin_generator_length 1.6"},
    "y": {"periodic": "", "walls": "-boundary_y wall", "moving wall": "-boundary_y wall -boundary_ymax_velocity .4,0,0 "
          "-boundary_ymax_angular_frequency 2", "symmetry": "-boundary_y wall -boundary_ymin symmetry",
          "pressure": "-boundary_y wall -boundary_ymax pressure -boundary_ymax_pressure .1"},
    "bodies": {
        "none": None, "solid": f"{BALL} -cell_shear_modulus .6", "mooney_rivlin": f"{BALL} -cell_law mooney_rivlin -cell_c1 .2 "
        "-cell_c2 .1 -cell_c3 .1", "stretched": f"{BALL} -cell_shear_modulus .5 -cell_initial_stretch 1.1,.909090909,1",
        "viscous solid": f"{BALL} -cell_shear_modulus .5 -cell_viscosity 3",
        "drop": f"{BALL} -cell_shear_modulus 0 -cell_surface_tension .4 -cell_viscosity .3",
        "membrane": f"{BALL} -cell_law membrane -cell_surface_shear_modulus .2",
        "skalak, bending": f"{BALL} -cell_law membrane -cell_membrane_law skalak -cell_surface_shear_modulus .2 "
                           "-cell_bending_modulus .01 -cell_viscosity 2",
        "membrane, grid": f"{BALL} -cell_law membrane -cell_surface_shear_modulus .2 -cell_membrane_scheme grid",
        "pulled membrane": f"{BALL} -cell_law membrane -cell_surface_shear_modulus .2 -cell_stretch_force .1"},
    "places": {"one": "-cell_centre 1,.95,1.1", "two that touch": "-cell_placement list -cell_positions PAIR",
               "random": "-cell_placement random -cell_count 2 -cell_seed 3",
               "merging": "-cell_placement list -cell_positions PAIR -cell_contact merge"},
    "others": {
        "none": None, "solid": "-other_shape ellipsoid -other_semi_axes .3,.45,.4 -other_centre 2.7,1.1,1.1 -other_shear_modulus 1",
        "slab": "-other_shape slab -other_axis y -other_interval 0,.3 -other_shear_modulus 2",
        "tube": "-other_shape tube -other_axis x -other_radius .95 -other_centre 0,1.05,1.2 -other_shear_modulus 3",
        "rigid tube": "-other_shape tube -other_axis x -other_radius .95 -other_centre 0,1.05,1.2 -other_law rigid",
        "rigid post": "-other_shape sphere -other_radius .35 -other_centre 2.5,1.2,1.1 -other_law rigid",
        "turning": "-other_shape ellipsoid -other_semi_axes .5,.3,.4 -other_centre 2.5,1.2,1.1 -other_law rigid "
                   "-other_angular_velocity 0,0,1",
        "travelling": "-other_shape sphere -other_radius .35 -other_centre 2.5,1.2,1.1 -other_law rigid -other_velocity .5,0,0 "
                      "-other_velocity_angular_frequency 2",
        "from a file": "-other_shape voxels -other_voxels VOLUME -other_shear_modulus 1"},
    "forces": {"none": "", "steady": "-body_force .3,.1,0", "pulsating": "-body_force .3,0,0 -body_force_angular_frequency 2",
               "of a species": "-cell_body_force .2,-.3,0", "no inertia": "-fluid_inertia false -body_force .3,0,0"},
    "start": {"rest": "", "carried": "-initial_velocity_mean .3,0,0", "vortex": "-initial_velocity taylor_green "
              "-initial_velocity_amplitude .3"},
    "outputs": {"few": "-series_interval .02", "many": "-series_interval .013 -profile_y mean -probe_points .5,.5,0:1.9,.7,0 -snapshot_interval .05",
                "exact": "-series_interval .02 -snapshot_interval .03 -snapshot_times exact -snapshot_fields velocity,pressure,left_cauchy_green,body",
                "no names": "-series_interval .02 -body_series false"},
}
# A coarse grid may do what guards forbid; the question is whether all ranks do the same.
COMMON = ("-fluid_viscosity .5 -time_end 1000 -guard_divergence 0 -guard_volume_drift 0 -guard_energy_growth 0 -guard_mach 0 "
          "-guard_cfl 0").split()


def files(room):
    """Writes the input files that scenes name; {placeholder: path}."""
    import h5py
    import numpy
    pair = room / "pair.csv"
    pair.write_text("x,y,z\n1,.95,1.1\n2.03,1,1.1\n")
    places = {"PAIR": str(pair)}
    for dimension, shape in (("2-D", (1, 21, 36)), ("3-D", (12, 13, 18))):
        z, y, x = numpy.indices(shape)
        hills = y < .12 * shape[1] + 1.5 * numpy.sin(x + z)
        places[f"VOLUME {dimension}"] = str(room / f"volume_{dimension}.h5")
        with h5py.File(places[f"VOLUME {dimension}"], "w") as file:
            file["solid_fraction"] = hills.astype(float)
    return places


def words(values, places):
    """Command-line words of a scene, {feature: name of its value}."""
    options = {feature: FEATURES[feature][value] for feature, value in values.items()}
    species = [name for name, feature in (("cell", "bodies"), ("other", "others")) if options[feature] is not None]
    if options["bodies"] is None:
        options["places"] = ""
    line = " ".join(text for text in options.values() if text).split()
    line = [places.get(word) or places.get(f"{word} {values['dimension']}", word) for word in line]
    return [*COMMON, *line, *(["-species", ",".join(species)] if species else [])]


def makes_sense(values):
    """Options of cells need cells, and elastic walls may not reach a boundary that fluid crosses."""
    if values["bodies"] == "none" and (values["places"] != "one" or values["forces"] == "of a species"):
        return False
    if values["x"] == "feeder" and values["dimension"] == "3-D" and values["others"] == "rigid post":
        return False  # the lumen must be the same all along a feeder
    driven = (values["start"] != "rest" or values["forces"] != "none" or values["x"] not in ("periodic", "walls") or
              values["y"] in ("moving wall", "pressure") or values["bodies"] != "none" or values["others"] != "none")
    if values["outputs"] == "exact" and not driven:
        return False  # nothing limits the step, in which there would be thousands of snapshots
    crossed = values["x"] not in ("periodic", "walls") or values["y"] == "pressure"
    if crossed and values["others"] == "solid" and values["outputs"] == "no names" and values["method"] in ("classic", "weno5"):
        return False  # the tails that WENO5 makes come to the side, and what has no label cannot leave
    return not (crossed and values["others"] in ("slab", "tube", "from a file"))


def candidates(number, seed):
    dice = random.Random(seed)
    found = []
    while len(found) < number:
        values = {feature: dice.choice(list(choices)) for feature, choices in FEATURES.items()}
        if makes_sense(values):
            found.append(values)
    return found


def pairs(values):
    return set(itertools.combinations(values.items(), 2))


def cover(accepted):
    """The scenes of `accepted` that together have every pair that any of them has."""
    sets = [pairs(values) for values in accepted]
    missing, chosen = set().union(*sets), []
    while missing:
        best = max(range(len(sets)), key=lambda n: (len(sets[n] & missing), -n))
        chosen.append(accepted[best])
        missing -= sets[best]
    return chosen
