#include "options/option_table.hpp"

#include "options/option_rows.hpp"
#include "options/petsc_options.hpp"
#include "options/renamed_options.hpp"

#include <set>

namespace eulastic {
namespace {

const Names method_names{"fast", "classic"};

void add_grid(Rows &rows, Config &config) {
  rows.group = "Grid";
  rows.numbers("grid_cells", config.grid.cells.data(), 3, at_least_one, "",
               "number of grid cells along x, y and z; 1 along z selects a 2-D simulation, in which the z coordinate "
               "of bodies is ignored")
      .accepted = "3 integers separated by commas: at least 3 in x and y, 1 (2-D) or at least 3 in z";
  rows.real("grid_length", config.grid.length, positive, "length", "edge lengths of the box along x, y and z");
  rows.may_change = true;
  for (int d = 0; d < 3; ++d) {
    rows.integer(std::string("da_processors_") + "xyz"[d], config.grid.processors[d], {0, false},
                 std::string("number of MPI ranks along ") + "xyz"[d] + "; auto: chosen by the program");
    rows.zero_is("auto");
  }
  rows.integer("threads", config.threads, {1, false, 1024},
               "number of threads of each MPI rank; they share the planes of cells (in 2-D the rows) and the bodies of "
               "the rank");
  rows.boolean("load_balance", config.balance,
               "whether the box is cut along y and z into parts of equal estimated work, at the start and at restarts; "
               "false: into parts with equal numbers of cells");
  rows.may_change = false;
}

void add_flow(Rows &rows, Config &config) {
  rows.group = "Fluid";
  Fluid &fluid = config.fluid;
  rows.real("fluid_density", fluid.density, positive, "mass/volume",
            "density, which is the same for the fluid and all bodies");
  rows.real("fluid_viscosity", fluid.viscosity, not_negative, "mass/length/time",
            "dynamic viscosity of the fluid, and of the bodies of every species without -NAME_viscosity");
  rows.boolean("fluid_inertia", fluid.inertia,
               "whether the momentum equation has the convective term v.grad v; false: unsteady Stokes flow");
  rows.real("body_force", fluid.body_force.force, any_number, "length/time^2",
            "amplitude F of the force per mass on fluid and bodies, F cos(angular_frequency t + phase)");
  rows.oscillation("body_force_", fluid.body_force.frequency, fluid.body_force.phase, " of the force");

  rows.group = "Initial flow";
  InitialFlow &initial = config.initial;
  rows.choice(
      "initial_velocity", initial.kind, initial_velocity_names(),
      "flow at t = 0, to which -initial_velocity_mean is added; zero and uniform: nothing but this mean; taylor_green: "
      "vortices in the x-y plane; taylor_green_3d: vortices in x, y and z; shear_layer: two opposite shear layers in "
      "y; couette: linear in y between walls; poiseuille: parabolic in y between walls; shear_wave_ab: component a of "
      "the velocity is a sine along b; random: a solenoidal field of random waves");
  rows.limit("-initial_velocity other than zero, uniform and couette", [&initial] {
    return initial.kind != InitialVelocity::zero && initial.kind != InitialVelocity::uniform &&
           initial.kind != InitialVelocity::couette;
  });
  rows.real("initial_velocity_amplitude", initial.amplitude, any_number, "length/time",
            "amplitude of the flow that -initial_velocity selects");
  rows.end_limit();
  rows.real("initial_velocity_mean", initial.mean, any_number, "length/time",
            "uniform velocity that is added to the initial flow");
  rows.path("initial_state", config.initial_state,
            "HDF5 file with initial fields, such as a snapshot; its fields replace those that other options describe "
            "(docs/outputs.md)")
      .names_file = any_file;
}

void add_bodies(Rows &rows, Config &config) {
  rows.group = "Bodies";
  Option &species = rows.add("species", "",
                             "names of the species, that is, of groups of bodies with the same shape and material; "
                             "each has its own set of the options -NAME_...; none: no bodies");
  species.accepted = "a list without spaces of names made of letters, digits and _, beginning with a letter";
  species.default_note = "none";
  species.read = [](const std::string &) { return std::string(); };  // read before this table, which it lengthens
  species.text = [&config] {
    Names names;
    for (const SpeciesSpec &spec : config.species) names.push_back(spec.name);
    return join(names, ",");
  };
  rows.boolean("body_series", config.body_series,
               "whether every body is labelled, tracked and measured; false saves this cost, but then there is no "
               "bodies.h5 and no field body in snapshots");
  for (SpeciesSpec &spec : config.species) {
    rows.group = "Bodies: species " + spec.name;
    add_species_rows(rows, spec, !config.initial_state.empty());
  }
}

// What the two presets say; the default of a row that they set.
std::string by_method(const Option &row, Method &method) {
  const Method present = method;
  method = method_preset(MethodKind::fast);
  const std::string fast = row.text();
  method = method_preset(MethodKind::classic);
  const std::string classic = row.text();
  method = present;
  return fast == classic ? fast : fast + "; " + classic + " with -method classic";
}

void add_method(Rows &rows, Config &config) {
  rows.group = "Method";
  Method &method = config.method;
  rows.choice("method", method.kind, method_names,
              "numerical method, which sets the defaults of the options below; fast: second order in time, with bodies "
              "at half steps; classic: the explicit Euler scheme of Sugiyama et al. (2013)");
  const std::size_t parts = rows.rows.size();
  rows.restrict("method", method.kind, method_names, {MethodKind::fast});
  rows.choice("viscous_scheme", method.viscous, {"auto", "rkl", "explicit"},
              "time integration of the viscous force; rkl: super time stepping RKL2 in several explicit stages; "
              "explicit: a single stage, which needs short time steps; auto: an implicit step if viscosities differ "
              "and no body is rigid, otherwise rkl");
  rows.real("viscous_tolerance", method.viscous_tolerance, positive, "",
            "relative residual below which the iterations of the implicit viscous step stop; at most 0.1 times the "
            "square root of the least over the largest viscosity is taken");
  rows.choice("interface_scheme", method.interface, {"plic", "weno5"},
              "transport of the solid fraction; plic: a plane in each cut cell, which keeps interfaces sharp and "
              "conserves volume; weno5: WENO5 differences, which smear interfaces");
  rows.choice("solid_exterior", method.exterior, {"extrapolate", "identity"},
              "left Cauchy-Green tensor B outside the bodies; extrapolate: extrapolated from the body; identity: reset "
              "to the identity");
  rows.choice("elastic_force", method.elastic_force, {"linear", "constant"},
              "time dependence of the elastic force within a step; linear: linear in time; constant: the force at the "
              "middle of the step");
  rows.end_limit();
  rows.may_change = true;
  const Names pressure_names{"acm", "smac", "ksp"};
  rows.choice("pressure_solver", method.pressure, pressure_names,
              "solver of the pressure; acm: iterations of artificial compressibility; smac: direct solution of the "
              "Poisson equation by FFT; ksp: PETSc's solver of -pressure_ksp_type and -pressure_pc_type");
  rows.restrict("pressure_solver", method.pressure, pressure_names, {PressureKind::acm});
  rows.integer("acm_iterations_max", method.acm_sweeps_max, at_least_one,
               "maximum number of pressure iterations in a time step; 1: the single step of the original scheme");
  rows.real(
      "acm_tolerance", method.acm_tolerance, positive, "",
      "value of rms(div v) h/U below which the pressure iterations stop, with h the spacing and U the largest speed");
  rows.integer("acm_search_directions", method.acm_memory, {0, false, 4},
               "number of pressure increments of earlier steps that are used as additional search directions");
  rows.boolean("acm_coarse", method.acm_coarse,
               "whether the pressure iterations are preconditioned by a multigrid V-cycle");
  rows.end_limit();
  rows.may_change = false;
  for (std::size_t r = parts; r < rows.rows.size(); ++r) rows.rows[r].default_note = by_method(rows.rows[r], method);
}

// `mean`, or where the line cuts the plane of the other two directions.
void add_profile(Rows &rows, ProfileSpec &profile, int d) {
  const int a = d == 0 ? 1 : 0, b = d == 2 ? 1 : 2;
  const std::string plane{"xyz"[a], ',', "xyz"[b]};
  Option &row = rows.add(std::string("profile_") + "xyz"[d], "length",
                         std::string("profile of the flow along ") + "xyz"[d] +
                             ", at the centres of the cells; mean: averaged over planes normal to it; " +
                             "2 numbers: along the line with these coordinates " + plane);
  row.accepted = "mean, or 2 numbers " + plane;
  row.default_note = "none";
  row.read = [&profile, a, b](const std::string &value) {
    profile.kind = ProfileSpec::Kind::mean;
    if (value == "mean") return std::string();
    profile.kind = ProfileSpec::Kind::line;
    double place[2];
    std::string wrong = read_numbers(value, any_number, place, 2);
    if (wrong.empty()) profile.line[a] = place[0], profile.line[b] = place[1];
    return wrong;
  };
  row.text = [&profile, a, b] {
    if (profile.kind == ProfileSpec::Kind::none) return std::string();
    if (profile.kind == ProfileSpec::Kind::mean) return std::string("mean");
    return to_text(profile.line[a]) + "," + to_text(profile.line[b]);
  };
}

void add_samples(Rows &rows, Config &config) {
  SampleControl &samples = config.samples;
  Option &probes =
      rows.add("probe_points", "length",
               "points at which probes.csv records velocity and pressure, whenever a row of series.csv is written");
  probes.accepted = "points x,y,z separated by colons, x,y,z:x,y,z";
  probes.default_note = "none";
  probes.read = [&samples](const std::string &value) { return read_points(value, &samples.probes); };
  probes.text = [&samples] {
    Names points;
    for (const Real3 &p : samples.probes) points.push_back(list(p.data(), 3));
    return join(points, ":");
  };
  for (int d = 0; d < 3; ++d) add_profile(rows, samples.profile[d], d);
  rows.real("profile_interval", samples.profile_interval, not_negative, "time",
            "time between profiles, which are also written at the start and the end of the run; off: only at the end");
  rows.zero_is("off");
}

void add_output(Rows &rows, Config &config) {
  rows.group = "Output";
  OutputControl &output = config.output;
  rows.path("output_dir", output.directory, "directory of all files that the run writes");
  rows.boolean("output_overwrite", output.overwrite,
               "whether an earlier run in -output_dir is replaced; accepted on the command line only")
      .command_line = true;
  rows.real("snapshot_interval", output.snapshot_interval, not_negative, "time",
            "time between snapshots of the fields, which are also written at the start and the end of the run; off: no "
            "snapshots");
  rows.zero_is("off");
  rows.choice("snapshot_times", output.snapshot_exact, {"steps", "exact"},
              "times of the snapshots; steps: the first time step at or after each multiple of -snapshot_interval; "
              "exact: interpolated to the multiple itself");
  rows.words("snapshot_fields", output.snapshot_fields,
             {"velocity", "pressure", "solid_fraction", "body", "left_cauchy_green", "wall_shear_stress"},
             "fields that snapshots contain");
  rows.choice("snapshot_precision", output.snapshot_single, {"double", "single"},
              "precision of the numbers in snapshots; double: 8 bytes; single: 4 bytes");
  rows.choice("snapshot_format", output.snapshot_vti, {"xdmf", "vti"},
              "files for ParaView; xdmf: one index of all snapshots; vti: also one .vti file per snapshot, which every "
              "version of VTK and ParaView reads and which always contains the wall shear stress");
  rows.real("series_interval", output.series_interval, not_negative, "time",
            "time between rows of series.csv and between records of bodies.h5");
  rows.zero_is("auto");
  rows.rows.back().default_note = "auto: -time_end/200";
  add_samples(rows, config);
}

void add_checkpoints(Rows &rows, Config &config) {
  rows.group = "Checkpoints and restart";
  CheckpointControl &checkpoint = config.checkpoint;
  rows.limit("-checkpoint_keep > 0", [&checkpoint] { return checkpoint.keep > 0; });
  rows.real("checkpoint_interval", checkpoint.interval, not_negative, "time",
            "simulated time between checkpoints; off: they are written by wall time and at the end only");
  rows.zero_is("off");
  rows.real("checkpoint_wall_minutes", checkpoint.wall_minutes, not_negative, "minutes",
            "wall time between checkpoints; off: they are written by simulated time and at the end only");
  rows.zero_is("off");
  rows.end_limit();
  rows.integer("checkpoint_keep", checkpoint.keep, {0, false},
               "number of latest checkpoints that are kept during the run; a complete run keeps the one of its end; 0: "
               "no checkpoints");
  rows.real("stop_after_minutes", checkpoint.stop_after_minutes, not_negative, "minutes",
            "wall time after which the run writes a checkpoint and stops, to be continued with -restart; unlimited: it "
            "runs to the end");
  rows.zero_is("unlimited");
  rows.path("restart", checkpoint.restart,
            "checkpoint from which the run continues, or an output directory, of which the newest intact checkpoint is "
            "used; with the same -output_dir its files are continued");
}

void add_guards(Rows &rows, Config &config) {
  rows.group = "Guards: bounds that stop the run";
  GuardControl &guard = config.guard;
  const auto bound = [&rows](const std::string &name, double &target, const std::string &doc) {
    rows.real("guard_" + name, target, not_negative, "", doc);
    rows.zero_is("off");
  };
  bound("cfl", guard.cfl, "largest CFL number, the sum of max |v_i| dt/h_i over the directions");
  bound("divergence", guard.divergence, "largest rms(div v) h/U, the column divergence_rms of series.csv");
  bound("mach", guard.mach,
        "largest Mach number, |v| over the sound speed of artificial compressibility; checked where the pressure takes "
        "a single step (-acm_iterations_max 1)");
  bound("volume_drift", guard.volume_drift, "largest relative change of the volume of a body");
  bound("energy_growth", guard.energy_growth,
        "largest energy that numerical errors generate in any part of the run, relative to the energy held at its "
        "beginning and supplied since");
  bound("memory", guard.memory,
        "largest memory that the ranks of a node need, relative to its physical memory; checked before the run starts");
}

void add_program(Rows &rows, Config &config) {
  rows.group = "Program";
  rows.boolean("check_only", config.check_only,
               "whether the program only validates the case and prints derived numbers, such as time step, memory and "
               "wall time, and stops");
  rows.integer("ranks", config.ranks, {0, false, 1e8},
               "number of MPI ranks that -check_only assumes; auto: the number that mpiexec starts");
  rows.zero_is("auto");
  rows.boolean("print_options", config.print_options,
               "whether the program only validates the case, prints every option with its resolved value, and stops");
  rows.add("options_file", "",
           "options file to include; options of the including file override those of the included one")
      .accepted = "only in an options file; a path, from the directory of this file";
  rows.add("help", "",
           "print all options and stop; -help WORD: the options with this word in name, text or values; -help "
           "markdown: the page docs/options.md; -help man: a manual page; -h: a summary")
      .accepted = "only on the command line";
  rows.add("version", "", "print the version and stop").accepted = "only on the command line";
}

// All that may change at a restart.
void add_running(Rows &rows, Config &config) {
  rows.may_change = true;
  rows.group = "Time";
  rows.real("time_end", config.time.end, positive, "time", "simulated time at which the run ends").required = true;
  rows.real("time_step", config.time.step, not_negative, "time", "time step; auto: the largest stable one");
  rows.zero_is("auto");
  rows.integer("time_steps_max", config.time.steps_max, {0, false},
               "number of time steps after which the run ends, if -time_end has not been reached");
  rows.zero_is("unlimited");
  add_output(rows, config);
  add_checkpoints(rows, config);
  add_guards(rows, config);
  add_program(rows, config);
}

}  // namespace

std::string read_method(const std::string &value, Config *config) {
  int kind = 0;
  std::string wrong = read_choice(value, method_names, &kind);
  if (wrong.empty()) config->method = method_preset(static_cast<MethodKind>(kind));
  return wrong;
}

std::vector<Option> option_table(Config &config) {
  Rows rows;
  add_grid(rows, config);
  add_boundaries(rows, config);
  add_flow(rows, config);
  add_bodies(rows, config);
  add_adhesion(rows, config);
  add_method(rows, config);
  add_running(rows, config);
  return std::move(rows.rows);
}

bool is_reserved_word(const std::string &word) {
  static const std::set<std::string> words = [] {
    const auto first = [](const std::string &name) { return name.substr(0, name.find('_')); };
    std::set<std::string> set;
    Config config;
    for (const Option &option : option_table(config)) set.insert(first(option.name));
    for (const std::string &name : petsc_option_names()) set.insert(first(name));
    for (const RenamedOption &option : renamed_options()) set.insert(first(option.former));
    set.erase("NAME");
    return set;
  }();
  return words.count(word) > 0;
}

}  // namespace eulastic
