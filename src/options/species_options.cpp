
#include "options/option_rows.hpp"

namespace eulastic {
namespace {

void add_voxel_rows(Rows &rows, VoxelSpec &voxels) {
  Option &path = rows.path("voxels", voxels.path,
                           "file of the body: solid fractions or a mask of voxels (HDF5, NRRD), or a closed surface "
                           "(STL); docs/voxels.md describes the formats");
  path.accepted = "a path, of HDF5 also FILE:DATASET";
  path.required = true;
  path.names_file = any_file;
  const auto unless_not_given = [](Option &option, const Real3 &value, const char *note) {
    option.default_note = note;
    option.text = [text = option.text, &value] { return value[0] == value[0] ? text() : std::string(); };
  };
  unless_not_given(rows.real("voxels_spacing", voxels.spacing, positive, "length",
                             "edge lengths of a voxel; for an STL file the unit of its coordinates"),
                   voxels.spacing,
                   "from the file, otherwise such that the volume fills the box; 1,1,1 for an STL file");
  unless_not_given(
      rows.real("voxels_origin", voxels.origin, any_number, "length",
                "position in the box of the low corner of the first voxel, or of the point 0,0,0 of an STL file"),
      voxels.origin, "from the file if the spacing comes from it, otherwise 0,0,0");
  rows.boolean(
      "voxels_invert", voxels.invert,
      "whether solid and fluid of the file are exchanged, as needed if it marks the lumen rather than the wall");
}

void add_anchored_row(Rows &rows, SpeciesSpec &spec) {
  Option &row = rows.optional(spec.anchored, [&](bool &anchored) -> Option & {
    return rows.boolean(
        "anchored", anchored,
        "whether the body is an elastic wall that hardly moves (slab, tube, vessel); its left Cauchy-Green tensor is "
        "then extrapolated linearly, which is of second order for small displacements");
  });
  row.default_note = "true for slabs and tubes, otherwise false";
  row.text = [&spec] { return spec.anchored.value_or(is_anchored(spec.shape)) ? "true" : "false"; };
}

const Names shape_names{"sphere", "biconcave",        "ellipsoid", "cylinder", "slab",
                        "tube",   "constricted_tube", "voxels",    "state"};
const Names law_names{"neo_hookean", "mooney_rivlin", "membrane", "red_cell", "rigid"};
const Names membrane_names{"neo_hookean", "skalak"};
const Names membrane_scheme_names{"grid", "markers"};
const Names placement_names{"one", "list", "lattice", "random"};

void add_shape(Rows &rows, SpeciesSpec &spec, bool from_state) {
  const auto for_shapes = [&](const std::vector<Shape> &wanted) {
    rows.restrict(rows.prefix + "shape", spec.shape, shape_names, wanted);
  };
  rows.choice("shape", spec.shape, shape_names,
              "shape of the bodies; biconcave: that of a resting red blood cell; cylinder: infinite along its axis; "
              "slab: a layer; tube: everything outside a cylindrical lumen; constricted_tube: a tube with a stenosis; "
              "voxels: from the file -NAME_voxels; state: from the file -initial_state, and the default with it; in "
              "2-D a body is the section of its shape through its centre, normal to z")
      .required = !from_state;
  for_shapes({Shape::sphere, Shape::biconcave, Shape::cylinder, Shape::tube, Shape::constricted_tube});
  rows.real("radius", spec.radius, positive, "length", "radius of the body; for tubes that of the lumen").required =
      true;
  Option &diameter = rows.real("diameter", spec.radius, positive, "length",
                               "diameter of the body or lumen, given instead of the radius");
  diameter.alias_of = rows.prefix + "radius";
  diameter.text = nullptr;
  diameter.read = [read = diameter.read, &spec](const std::string &value) {
    std::string wrong = read(value);
    if (wrong.empty()) spec.radius /= 2;
    return wrong;
  };
  for_shapes({Shape::constricted_tube});
  rows.real("throat_radius", spec.throat_radius, positive, "length", "radius of the lumen at its narrowest position")
      .required = true;
  rows.real("throat_length", spec.throat_length, positive, "length",
            "length of the constriction along the axis; the radius follows a cosine around the centre")
      .required = true;
  for_shapes({Shape::ellipsoid});
  rows.real("semi_axes", spec.semi_axes, positive, "length",
            "semi-axes of the ellipsoid along x, y and z, before -NAME_orientation rotates it")
      .required = true;
  for_shapes({Shape::biconcave, Shape::cylinder, Shape::slab, Shape::tube, Shape::constricted_tube});
  rows.choice("axis", spec.axis, {"x", "y", "z"}, "direction of the axis of symmetry, or of the normal of a slab");
  for_shapes({Shape::slab});
  rows.real("interval", spec.interval, any_number, "length",
            "coordinates of the low and the high face of the slab along its axis")
      .required = true;
  for_shapes({Shape::voxels});
  add_voxel_rows(rows, spec.voxels);
  rows.end_limit();
}

void add_membrane(Rows &rows, SpeciesSpec &spec) {
  const auto for_membranes = [&] {
    rows.restrict(rows.prefix + "law", spec.law, law_names, {Law::membrane, Law::red_cell});
  };
  for_membranes();
  rows.choice("membrane_law", spec.membrane.law, membrane_names, "elastic law of the membrane in its plane");
  rows.choice("membrane_scheme", spec.membrane.scheme, membrane_scheme_names,
              "how the strain of the membrane is stored; markers: by material points on the membrane, which know their "
              "undeformed positions; grid: as a field on the grid, which is diffusive");
  rows.real("surface_shear_modulus", spec.membrane.shear_modulus, positive, "force/length",
            "surface shear modulus G_s of the membrane")
      .required = true;
  rows.limit("-" + rows.prefix + "membrane_law skalak",
             [&spec] { return spec.is_membrane() && spec.membrane.law == kernels::MembraneLaw::skalak; });
  rows.real("skalak_c", spec.membrane.area_modulus, not_negative, "",
            "coefficient C of Skalak's law: the area dilation modulus is (1 + 2 C) G_s; with -NAME_membrane_law "
            "neo_hookean it is 3 G_s");
  for_membranes();
  rows.real("initial_area_stretch", spec.membrane.initial_area_stretch, positive, "",
            "initial area of the membrane relative to its undeformed area; above 1 the membrane is under tension from "
            "the start");
  rows.real("bending_modulus", spec.membrane.bending_modulus, not_negative, "energy",
            "bending modulus E_b of the membrane: the bending energy per area is E_b/2 (kappa - c0)^2, with kappa the "
            "sum of the principal curvatures; 0: no resistance to bending");
  rows.real("spontaneous_curvature", spec.membrane.spontaneous_curvature, any_number, "1/length",
            "spontaneous curvature c0 of the bending energy, which is 0 for a sphere of radius 2/c0, in 2-D for a disc "
            "of radius 1/c0");
  rows.real("stretch_force", spec.stretch_force.force, not_negative, "force",
            "force that pulls the two ends of every body apart along x, as optical tweezers do; in 2-D per unit depth");
  rows.real("stretch_volume_fraction", spec.stretch_force.volume, {0, true, 0.5}, "",
            "share of the volume of the body, at each end, on which -NAME_stretch_force acts; the default corresponds "
            "to the outer 0.5 um of a red cell");
}

void add_law(Rows &rows, SpeciesSpec &spec) {
  const auto for_law = [&](Law wanted) { rows.restrict(rows.prefix + "law", spec.law, law_names, {wanted}); };
  rows.choice("law", spec.law, law_names,
              "constitutive law of the bodies; neo_hookean: the stress is the deviator of G B, with B the left "
              "Cauchy-Green tensor; mooney_rivlin: the stress is the deviator of 2 c1 B + 2 c2 (tr(B) B - B.B) + 4 c3 "
              "(tr B - 3) B; membrane: an elastic membrane around a fluid; red_cell: a membrane with the parameters of "
              "a red blood cell in um, us and mPa s, -NAME_shape biconcave and -NAME_viscosity 6, each of which its "
              "own option overrides; rigid: a body that does not deform and moves only as prescribed");
  for_law(Law::neo_hookean);
  rows.real("shear_modulus", spec.shear_modulus, not_negative, "pressure",
            "shear modulus G; 0: the bodies are drops of a fluid")
      .required = true;
  for_law(Law::mooney_rivlin);
  rows.real("c1", spec.c1, not_negative, "pressure",
            "first coefficient c1 of the Mooney-Rivlin law; the shear modulus of the undeformed body is 2 (c1 + c2)")
      .required = true;
  rows.real("c2", spec.c2, not_negative, "pressure", "second coefficient c2 of the Mooney-Rivlin law");
  rows.real("c3", spec.c3, not_negative, "pressure",
            "third coefficient c3, which stiffens the body with the square of the strain");
  add_membrane(rows, spec);
  for_law(Law::rigid);
  rows.real("velocity", spec.motion.velocity, any_number, "length/time",
            "amplitude V of the velocity V cos(angular_frequency t + phase) of a rigid body, which moves through the "
            "grid (a slab along its axis, as a piston) or slides along its own surface (a tube or a cylinder along its "
            "axis, a slab in its plane)");
  rows.oscillation("velocity_", spec.motion.of_velocity.frequency, spec.motion.of_velocity.phase, " of the velocity");
  rows.real("angular_velocity", spec.motion.angular_velocity, any_number, "rad/time",
            "amplitude W of the angular velocity W cos(angular_frequency t + phase) of a rigid body about its centre, "
            "of a cylinder about its axis");
  rows.oscillation("angular_velocity_", spec.motion.of_rotation.frequency, spec.motion.of_rotation.phase,
                   " of the angular velocity");
  rows.end_limit();
}

void add_surface_and_forces(Rows &rows, SpeciesSpec &spec) {
  rows.optional(spec.viscosity,
                [&](double &viscosity) -> Option & {
                  return rows.real("viscosity", viscosity, positive, "mass/length/time",
                                   "dynamic viscosity of the bodies, of a membrane that of the fluid inside");
                })
      .default_note = "that of the fluid";
  rows.real(
      "surface_tension", spec.surface_tension, not_negative, "force/length",
      "surface tension of the interface between the bodies and the fluid; a drop is a body with -NAME_shear_modulus 0");
  rows.real("body_force", spec.body_force.force, any_number, "length/time^2",
            "amplitude F of the force per mass F cos(angular_frequency t + phase) on the bodies of this species only, "
            "in addition to -body_force");
  rows.oscillation("body_force_", spec.body_force.frequency, spec.body_force.phase, " of the force");
  rows.real("initial_stretch", spec.initial_stretch, positive, "",
            "initial principal stretches l along the axes of the body, which -NAME_orientation rotates by R: the left "
            "Cauchy-Green tensor is R diag(l^2) R^T, for a membrane its part along the surface; -NAME_shape is the "
            "stretched shape; the product is 1, except for membranes");
}

void add_contact(Rows &rows, SpeciesSpec &spec) {
  rows.optional(spec.contact,
                [&](Contact &contact) -> Option & {
                  return rows.choice("contact", contact, {"separate", "merge"},
                                     "whether bodies of this species that touch stay separate, each stored in a box of "
                                     "cells of its own, or merge as drops do");
                })
      .default_note =
      "separate; merge for cylinders and bodies anchored to walls, and with -interface_scheme weno5 or -body_series "
      "false";
}

// 3 integers for a lattice, 1 for bodies at random: read before it is known which.
void add_count(Rows &rows, SpeciesSpec &spec) {
  Option &count = rows.add(
      "count", "", "number of bodies along x, y and z of a lattice, or the total number of randomly placed bodies");
  count.accepted = "with lattice 3 integers >= 1, separated by commas, with random an integer >= 0";
  count.default_note = "1,1,1 with lattice; random requires it or the hematocrit";
  count.read = [&spec](const std::string &value) {
    spec.count = {1, 1, 1};  // of a file that is overruled
    spec.number = -1;
    if (value.find(',') == std::string::npos) return read_numbers(value, {0, false}, &spec.number, 1);
    return read_numbers(value, at_least_one, spec.count.data(), 3);
  };
  count.text = [&spec] {
    if (spec.placement == Placement::random) return spec.number < 0 ? std::string() : std::to_string(spec.number);
    return list(spec.count.data(), 3);
  };
}

void add_orientation(Rows &rows, SpeciesSpec &spec) {
  rows.restrict(rows.prefix + "shape", spec.shape, shape_names, {Shape::sphere, Shape::biconcave, Shape::ellipsoid});
  Option &orientation = rows.add("orientation", "degrees",
                                 "initial rotation of the bodies by three angles, about x, then y, then z; random: "
                                 "each body has a random orientation");
  orientation.accepted = "random, or 3 numbers, separated by commas";
  orientation.read = [&spec](const std::string &value) {
    spec.random_orientation = value == "random";
    spec.orientation = {};
    return spec.random_orientation ? std::string() : read_numbers(value, any_number, spec.orientation.data(), 3);
  };
  orientation.text = [&spec] { return spec.random_orientation ? "random" : list(spec.orientation.data(), 3); };
  rows.end_limit();
}

void add_placement(Rows &rows, SpeciesSpec &spec) {
  const auto for_placement = [&](const std::vector<Placement> &wanted) {
    rows.restrict(rows.prefix + "placement", spec.placement, placement_names, wanted);
  };
  rows.choice("placement", spec.placement, placement_names,
              "number and positions of the bodies; one: a single body at -NAME_centre; list: the positions in a file; "
              "lattice: a regular lattice that fills the box; random: random positions without overlap");
  rows.limit("-" + rows.prefix + "placement one and a shape other than slab, state and soft voxels", [&spec] {
    const bool placed = spec.shape != Shape::slab && spec.shape < Shape::voxels;
    return spec.placement == Placement::one && (placed || (spec.shape == Shape::voxels && spec.law == Law::rigid));
  });
  rows.real("centre", spec.centre, any_number, "length",
            "centre of the body, of the lumen of a tube, or of its constriction; for rigid voxels the centre about "
            "which they rotate and torques are measured")
      .default_note = "centre of the box";
  for_placement({Placement::list});
  Option &positions = rows.path("positions", spec.positions_file,
                                "file with one row per body: x,y,z of its centre, or x,y,z and three angles of "
                                "rotation in degrees (docs/howto/numbers.md)");
  positions.required = true;
  positions.names_file = any_file;
  for_placement({Placement::lattice, Placement::random});
  add_count(rows, spec);
  for_placement({Placement::lattice});
  rows.real("jitter", spec.jitter, {0, false, 1}, "",
            "largest random displacement of the bodies, relative to the free distance between bodies of the lattice");
  for_placement({Placement::random});
  Option &hematocrit = rows.real("hematocrit", spec.hematocrit, {0, false, 1}, "",
                                 "volume fraction of the bodies in the lumen of the tube, or in the box without slabs "
                                 "and bodies from files; given instead of -NAME_count");
  hematocrit.default_note = "none";
  hematocrit.text = [&spec] { return spec.hematocrit < 0 ? std::string() : to_text(spec.hematocrit); };
  Option &inside = rows.path("inside", spec.inside,
                             "species of a tube or of voxels in whose lumen the bodies are placed; without it they "
                             "still avoid the solid of voxels");
  inside.accepted = "the name of a species of tubes or voxels";
  inside.default_note = "the only tube, or none";
  rows.real("gap", spec.gap, not_negative, "length",
            "minimum initial distance between bodies; the distance to walls is at least half of it, for membranes at "
            "least the spacing of the grid")
      .default_note = "0; for membranes the spacing of the grid";
  add_orientation(rows, spec);
  rows.limit(
      "-" + rows.prefix + "placement random, -" + rows.prefix + "orientation random or -" + rows.prefix + "jitter",
      [&spec] { return spec.placement == Placement::random || spec.random_orientation || spec.jitter > 0; });
  rows.integer("seed", spec.seed, {0, false}, "seed of the random numbers for positions and orientations");
  rows.end_limit();
}

}  // namespace

void add_species_rows(Rows &rows, SpeciesSpec &spec, bool from_state) {
  rows.prefix = spec.name + "_";
  add_shape(rows, spec, from_state);
  add_law(rows, spec);
  const auto for_all_but_rigid = [&] {
    rows.restrict(rows.prefix + "law", spec.law, law_names,
                  {Law::neo_hookean, Law::mooney_rivlin, Law::membrane, Law::red_cell});
  };
  for_all_but_rigid();
  add_surface_and_forces(rows, spec);
  rows.end_limit();
  add_anchored_row(rows, spec);
  for_all_but_rigid();
  add_contact(rows, spec);
  rows.end_limit();
  add_placement(rows, spec);
  rows.prefix.clear();
}

}  // namespace eulastic
