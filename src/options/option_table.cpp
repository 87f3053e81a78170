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
  rows.integers("grid_cells", config.grid.cells.data(), 3, at_least_one,
                "number of cells in x, y, z; 1 in z selects 2-D, where shapes ignore z");
  rows.real("grid_length", config.grid.length, positive, "length", "size of the box");
  const std::size_t processors = rows.rows.size();
  for (int d = 0; d < 3; ++d) {
    rows.integers(std::string("da_processors_") + "xyz"[d], &config.grid.processors[d], 1, {0, false},
                  std::string("ranks along ") + "xyz"[d]);
    rows.zero_is("auto");
  }
  rows.integers("threads", &config.threads, 1, {1, false, 1024},
                "threads per rank; they share its planes of cells, in 2-D its rows, and its bodies in boxes");
  rows.boolean("load_balance", config.balance,
               "load balance: cut y and z by the estimated cost of the cells, at the start and at restarts");
  rows.allow_change(processors);
}

void add_flow(Rows &rows, Config &config) {
  rows.group = "Fluid";
  Fluid &fluid = config.fluid;
  rows.real("fluid_density", fluid.density, positive, "mass/volume", "density of fluid and bodies");
  rows.real("fluid_viscosity", fluid.viscosity, not_negative, "mass/length/time",
            "dynamic viscosity of the fluid, and of bodies without -NAME_viscosity");
  rows.boolean("fluid_inertia", fluid.inertia, "whether the momentum equation has the term v.grad v");
  rows.real("body_force", fluid.body_force.force, any_number, "length/time^2",
            "force per mass F cos(angular_frequency t + phase) on fluid and bodies");
  rows.real("body_force_angular_frequency", fluid.body_force.frequency, not_negative, "rad/time", "angular frequency");
  rows.real("body_force_phase", fluid.body_force.phase, any_number, "rad", "phase");

  rows.group = "Initial flow";
  InitialFlow &initial = config.initial;
  rows.choice("initial_velocity", initial.kind, initial_velocity_names(),
              "flow at t = 0; shear_wave_ab: component a varies along b");
  Option &amplitude =
      rows.real("initial_velocity_amplitude", initial.amplitude, any_number, "length/time", "amplitude of that flow");
  amplitude.only_with = "-initial_velocity other than zero, uniform and couette";
  amplitude.applies = [&initial] {
    return initial.kind != InitialVelocity::zero && initial.kind != InitialVelocity::uniform &&
           initial.kind != InitialVelocity::couette;
  };
  rows.real("initial_velocity_mean", initial.mean, any_number, "length/time",
            "mean velocity that is added to the initial flow");
  rows.path("initial_state", config.initial_state,
            "HDF5 file with initial fields, or a snapshot; its fields override the options (docs/outputs.md)")
      .names_file = any_file;
}

void add_bodies(Rows &rows, Config &config) {
  rows.group = "Bodies";
  Option &species = rows.add("species", "", "names of the species; each has its own set of the options NAME_...");
  species.accepted = "a list without spaces of names made of letters, digits and _, beginning with a letter";
  species.default_note = "none";
  species.read = [](const std::string &) { return std::string(); };  // read before this table, which it lengthens
  species.text = [&config] {
    Names names;
    for (const SpeciesSpec &spec : config.species) names.push_back(spec.name);
    return join(names, ",");
  };
  rows.boolean(
      "body_series", config.body_series,
      "label, track and measure every body; false saves this cost: no labels, no bodies.h5, no body in snapshots");
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
              "fast: second order in time, with bodies at half steps; classic: the scheme of the original paper");
  const std::size_t parts = rows.rows.size();
  rows.choice("viscous_scheme", method.viscous, {"auto", "rkl", "explicit"},
              "rkl: super time stepping RKL2; explicit: a single stage; auto: rkl, but an implicit step where "
              "viscosities differ and no body is rigid");
  rows.real("viscous_tolerance", method.viscous_tolerance, positive, "",
            "iterate the implicit viscous step until its residual is below this share of the right-hand side");
  rows.choice("interface_scheme", method.interface, {"plic", "weno5"},
              "transport of the solid fraction: plic is sharp and conservative; or WENO5");
  rows.choice("solid_exterior", method.exterior, {"extrapolate", "identity"},
              "B outside bodies: extrapolated, or reset to I");
  rows.choice("elastic_force", method.elastic_force, {"linear", "constant"},
              "elastic force within a step: linear in time, or that of its middle");
  rows.restrict(parts, "method", method.kind, method_names, {MethodKind::fast});
  const Names pressure_names{"acm", "smac", "ksp"};
  const std::size_t pressure = rows.rows.size();
  rows.choice("pressure_solver", method.pressure, pressure_names,
              "artificial compressibility, the exact Poisson solution by FFT, or PETSc's by any -pressure_ksp_type and "
              "-pressure_pc_type");
  const std::size_t first = rows.rows.size();
  rows.integers("acm_iterations_max", &method.acm_sweeps_max, 1, at_least_one,
                "largest number of pressure iterations per step");
  rows.real("acm_tolerance", method.acm_tolerance, positive, "", "iterate until rms(div v) h/U is below this");
  rows.integers("acm_search_directions", &method.acm_memory, 1, {0, false, 4},
                "number of increments of earlier steps that are used as search directions");
  rows.boolean("acm_coarse", method.acm_coarse, "precondition the iterations by a V-cycle over coarse grids");
  rows.restrict(first, "pressure_solver", method.pressure, pressure_names, {PressureKind::acm});
  rows.allow_change(pressure);
  for (std::size_t r = parts; r < rows.rows.size(); ++r) rows.rows[r].default_note = by_method(rows.rows[r], method);
}

// `mean`, or where the line cuts the plane of the other two directions.
void add_profile(Rows &rows, ProfileSpec &profile, int d) {
  const int a = d == 0 ? 1 : 0, b = d == 2 ? 1 : 2;
  const std::string plane{"xyz"[a], ',', "xyz"[b]};
  Option &row =
      rows.add(std::string("profile_") + "xyz"[d], "length",
               std::string("profile of the flow along ") + "xyz"[d] +
                   ", at the centres of the cells: averaged over planes, " + "or along the line through " + plane);
  row.accepted = "mean, or 2 numbers " + plane;
  row.default_note = "none";
  row.read = [&profile, a, b](const std::string &value) {
    profile.kind = ProfileSpec::Kind::mean;
    if (value == "mean") return std::string();
    profile.kind = ProfileSpec::Kind::line;
    double place[2];
    std::string wrong = read_reals(value, any_number, place, 2);
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
      rows.add("probe_points", "length", "points at which probes.csv records the flow, with each row of series.csv");
  probes.accepted = "points x,y,z separated by colons, x,y,z:x,y,z";
  probes.default_note = "none";
  probes.read = [&samples](const std::string &value) { return read_points(value, &samples.probes); };
  probes.text = [&samples] {
    Names points;
    for (const Real3 &p : samples.probes) points.push_back(list(p.data(), 3, to_text));
    return join(points, ":");
  };
  for (int d = 0; d < 3; ++d) add_profile(rows, samples.profile[d], d);
  rows.real("profile_interval", samples.profile_interval, not_negative, "time",
            "time between profiles, which are also written at the start and the end; off: only at the end");
  rows.zero_is("off");
}

void add_output(Rows &rows, Config &config) {
  rows.group = "Output";
  OutputControl &output = config.output;
  rows.path("output_dir", output.directory, "directory of all output");
  rows.boolean("output_overwrite", output.overwrite,
               "replace the run in -output_dir; accepted on the command line only")
      .command_line = true;
  rows.real("snapshot_interval", output.snapshot_interval, not_negative, "time",
            "time between snapshots, which are also written at the start and the end; off: no snapshots");
  rows.zero_is("off");
  rows.choice(
      "snapshot_times", output.snapshot_exact, {"steps", "exact"},
      "steps: of the first step at or after each multiple of the interval; exact: interpolated to the multiple");
  rows.words("snapshot_fields", output.snapshot_fields,
             {"velocity", "pressure", "solid_fraction", "body", "left_cauchy_green", "wall_shear_stress"},
             "fields in snapshots");
  rows.choice("snapshot_precision", output.snapshot_single, {"double", "single"}, "precision of snapshots");
  rows.choice(
      "snapshot_format", output.snapshot_vti, {"xdmf", "vti"},
      "xdmf: one index of all snapshots; vti: also a file for each that every version of VTK and ParaView reads, with "
      "the wall shear stress always");
  rows.real("series_interval", output.series_interval, not_negative, "time", "time between rows of series.csv");
  rows.zero_is("auto");
  rows.rows.back().default_note = "auto: time_end/200";
  add_samples(rows, config);
}

void add_checkpoints(Rows &rows, Config &config) {
  rows.group = "Checkpoints and restart";
  CheckpointControl &checkpoint = config.checkpoint;
  const std::size_t regular = rows.rows.size();
  rows.real("checkpoint_interval", checkpoint.interval, not_negative, "time",
            "simulated time between checkpoints; off: only by wall time and at the end");
  rows.zero_is("off");
  rows.real("checkpoint_wall_minutes", checkpoint.wall_minutes, not_negative, "minutes",
            "wall time between checkpoints; off: only by simulated time and at the end");
  rows.zero_is("off");
  rows.limit(regular, "-checkpoint_keep > 0", [&checkpoint] { return checkpoint.keep > 0; });
  rows.integer("checkpoint_keep", checkpoint.keep, {0, false},
               "number of checkpoints that are kept; a complete run leaves one of its end, with 0 none");
  rows.real("stop_after_minutes", checkpoint.stop_after_minutes, not_negative, "minutes",
            "wall time after which the run writes a checkpoint and ends");
  rows.zero_is("unlimited");
  rows.path(
      "restart", checkpoint.restart,
      "checkpoint, or output directory, whose newest intact one is used; in the same -output_dir files are continued");
}

void add_guards(Rows &rows, Config &config) {
  rows.group = "Guards: bounds that stop the run";
  const std::size_t first = rows.rows.size();
  GuardControl &guard = config.guard;
  rows.real("guard_cfl", guard.cfl, not_negative, "", "CFL number, the sum of max |v_i| dt/h_i");
  rows.real("guard_divergence", guard.divergence, not_negative, "", "rms(div v) h/U, as in series.csv");
  rows.real("guard_mach", guard.mach, not_negative, "",
            "largest |v| over the sound speed of artificial compressibility, where there is one");
  rows.real("guard_volume_drift", guard.volume_drift, not_negative, "", "relative change of the volume of any body");
  rows.real(
      "guard_energy_growth", guard.energy_growth, not_negative, "",
      "energy made by the numerics within any time, relative to the energy held at its beginning and supplied since");
  rows.real("guard_memory", guard.memory, not_negative, "",
            "memory that the ranks of a node need, relative to its physical memory; checked before the start");
  for (std::size_t r = first; r < rows.rows.size(); ++r) rows.zero_is("off", r);
}

void add_program(Rows &rows, Config &config) {
  rows.group = "Program";
  rows.boolean("check_only", config.check_only, "validate the case, print derived numbers and stop");
  rows.integers("ranks", &config.ranks, 1, {0, false, 1e8},
                "number of ranks that -check_only assumes; auto: those of mpiexec");
  rows.zero_is("auto");
  rows.boolean("print_options", config.print_options,
               "validate the case, print every option with its resolved value and stop");
  rows.add("options_file", "", "file of options to include; options of the including file override it").accepted =
      "only in an options file; a path, from the directory of this file";
  rows.add("help", "",
           "print all options and stop; -help WORD: those with this word in name, text or values; -help markdown: "
           "docs/options.md; -help man: a manual page; -h: a summary")
      .accepted = "only on the command line";
  rows.add("version", "", "print the version and stop").accepted = "only on the command line";
}

// All that may change at a restart.
void add_running(Rows &rows, Config &config) {
  const std::size_t first = rows.rows.size();
  rows.group = "Time";
  rows.real("time_end", config.time.end, positive, "time", "end of the run").required = true;
  rows.real("time_step", config.time.step, not_negative, "time", "time step; auto: the largest stable one");
  rows.zero_is("auto");
  rows.integer("time_steps_max", config.time.steps_max, {0, false}, "largest number of steps");
  rows.zero_is("unlimited");
  add_output(rows, config);
  add_checkpoints(rows, config);
  add_guards(rows, config);
  add_program(rows, config);
  rows.allow_change(first);
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
