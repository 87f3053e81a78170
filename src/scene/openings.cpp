#include "scene/openings.hpp"

#include "base/exact_sum.hpp"
#include "base/number_rows.hpp"
#include "base/rank_zero.hpp"
#include "field/open_boundaries.hpp"
#include "io/hdf5_input.hpp"
#include "io/option_values.hpp"
#include "scene/inflow_balance.hpp"

#include <petscksp.h>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace eulastic {
namespace {

constexpr double round_off = 1e-9;  // of times and values that a text gives with some ten digits

// `source`: what gives the period, for messages.
std::string repeat(const std::string &source, double period, TimeCourse *course) {
  auto &table = course->table;
  const double length = table.back()[0] - table.front()[0];
  if (length > period * (1 + round_off))
    return source + ": " + to_text(period) + " is shorter than the table, whose times go from " +
           to_text(table.front()[0]) + " to " + to_text(table.back()[0]) + "; accepted: " + to_text(length) +
           " or longer";
  if (length >= period * (1 - round_off)) {  // the last row is the first one of the next period
    const double first = table.front()[1], last = table.back()[1];
    if (std::fabs(last - first) > round_off * course->largest())
      return source + ": the table ends with " + to_text(last) + " and begins again with " + to_text(first) +
             "; accepted: the same value, or a period that is longer than the table";
    table.pop_back();
  }
  course->period = period;
  return {};
}

// Reads a table of rows time,value, whose times ascend, and the period that a line "# period T" gives it. Collective.
// Returns what is wrong, or nothing.
std::string read_table(const std::string &path, TimeCourse *course) {
  static const RowFormat format{"rows of time,value", {"time", "value"}, {2}, false, "period"};
  std::string text;
  if (!read_file(path, &text)) return "cannot read " + path + "; accepted: " + format.expected;
  const auto add_row = [&](const std::vector<double> &row) {
    if (!course->table.empty() && !(row[0] > course->table.back()[0]))
      return "time " + to_text(row[0]) + " does not come after the one before; times must be ascending";
    course->table.push_back({row[0], row[1]});
    return std::string();
  };
  return read_rows(path, text, format, add_row, &course->period);
}

// Reads a number, or a table. Collective. Returns what is wrong, or nothing.
std::string read_course(const std::string &text, TimeCourse *course) {
  double value;
  if (read_numbers(text, any_number, &value, 1).empty()) {
    course->value = value;
    return {};
  }
  return read_table(text, course);
}

// Lets a table repeat as it or `spec` says, or refuses one that does not reach from 0 to the end of the run without
// being held. `side`: "-inflow_xmin"; `option`: the one that names `file`, the table. Returns one line, or nothing.
std::string extend_table(const OpeningSpec &spec, const std::string &side, const std::string &option,
                         const std::string &file, double end, TimeCourse *course) {
  if (course->table.empty()) {
    if (spec.period == 0 && !spec.hold) return {};
    return side + (spec.hold ? "_table_hold" : "_table_period") + ": applies only to a table; accepted: with a table";
  }
  if (spec.hold && spec.period > 0)
    return side + "_table_hold: given beside " + side + "_table_period; accepted: one of them";
  const std::string own = file + " says \"# period " + to_text(course->period) + "\"";
  if (spec.hold && course->period > 0)
    return side + "_table_hold: " + own + " and cannot also be held; accepted: false, or a table without a period";
  if (spec.hold) return {};
  if (spec.period > 0 && course->period > 0 && std::fabs(spec.period / course->period - 1) > round_off)
    return side + "_table_period: " + to_text(spec.period) + ", but " + own + "; accepted: the same, or one of them";
  if (spec.period > 0) return repeat(side + "_table_period", spec.period, course);
  if (course->period > 0) return repeat(option + ": the period of " + file, course->period, course);
  const double first = course->table.front()[0], last = course->table.back()[0];
  if (first <= 0 && last >= end * (1 - round_off)) return {};
  return option + ": " + file + " goes from time " + to_text(first) + " to " + to_text(last) + ", the run from 0 to " +
         to_text(end) + "; accepted: a table that covers the run, " + side +
         "_table_period to repeat it (in the file: # period T), or " + side +
         "_table_hold true to hold its first and its last value";
}

// Reads a profile, scaled to the mean 1, and its mean in the file.
std::string read_profile(const Config &config, int d, int high, InflowProfile *profile, double *mean) {
  const OpeningSpec &spec = config.openings[d][high];
  const Int3 &n = config.grid.cells;
  static const RowFormat format{"uniform, developed, or a file of numbers", {}, {}};
  std::string text, wrong, file, dataset;
  const bool hdf5 = on_rank_0([&] {
    split_dataset(spec.profile, &file, &dataset);
    return is_hdf5(file);
  });
  if (hdf5) {
    wrong = on_rank_0([&] {
      return read_profile_file(file, dataset, d == 2 ? n[1] : n[2], d == 0 ? n[1] : n[0], d, high ? -1 : 1, profile);
    });
    share(profile);
  } else if (read_file(spec.profile, &text)) {
    wrong = read_rows(spec.profile, text, format, [&](const std::vector<double> &row) {
      profile->insert(profile->end(), row.begin(), row.end());
      return std::string();
    });
  } else {
    wrong = "cannot read " + spec.profile + "; accepted: " + format.expected;
  }
  if (!wrong.empty()) return wrong;
  const std::size_t cells = std::size_t(n[0]) * n[1] * n[2] / n[d];
  if (profile->size() != cells)
    return spec.profile + " has " + std::to_string(profile->size()) +
           " numbers; accepted: one per cell of the boundary, " + std::to_string(cells);
  *mean = std::accumulate(profile->begin(), profile->end(), 0.0) / double(cells);
  for (double &value : *profile) value /= *mean;
  if (!std::isfinite(1 / *mean)) return spec.profile + ": its mean is 0; accepted: a flow into the box";
  return {};
}

std::string resolve_wall(const Config &config, int d, int high, BoundaryCondition *side) {
  const OpeningSpec &spec = config.openings[d][high];
  side->motion = {{}, spec.frequency, spec.phase};
  if (spec.velocity.empty()) return {};
  const std::string wrong = read_numbers(spec.velocity, any_number, side->motion.velocity.data(), 3);
  if (wrong.empty()) return {};
  return "-boundary_" + side_name(d, high) + "_velocity: " + wrong +
         "; accepted: for a wall 3 numbers, separated by commas";
}

std::string resolve_inflow(const Config &config, int d, int high, BoundaryCondition *side) {
  const OpeningSpec &spec = config.openings[d][high];
  const std::string name = "-boundary_" + side_name(d, high);
  if (!spec.velocity.empty() && !spec.flow_rate.empty())
    return name + "_flow_rate: given beside " + name + "_velocity; accepted: one of them";
  InflowProfile profile;
  double mean = 1;
  if (spec.from_file())
    if (std::string wrong = read_profile(config, d, high, &profile, &mean); !wrong.empty())
      return name + "_profile: " + wrong;
  side->profile = std::make_shared<const InflowProfile>(std::move(profile));
  const bool flow = !spec.flow_rate.empty();
  if (!flow && spec.velocity.empty() && !spec.from_file())
    return name + "_velocity: must be given, or " + name + "_flow_rate; accepted: a number, or a table";
  TimeCourse &course = side->given;
  course = {mean, spec.frequency, spec.phase, {}};
  const std::string option = name + (flow ? "_flow_rate" : "_velocity");
  const std::string &text = flow ? spec.flow_rate : spec.velocity;
  if (!text.empty())
    if (std::string wrong = read_course(text, &course); !wrong.empty()) return option + ": " + wrong;
  if (!course.table.empty() && (spec.frequency != 0 || spec.phase != 0))
    return name + "_angular_frequency: does not apply to a table; accepted: 0, and phase 0";
  if (std::string wrong = extend_table(spec, name, option, text, config.time.end, &course); !wrong.empty())
    return wrong;
  if (flow) {
    const double area = config.grid.side_area(d);
    course.value /= area;
    for (auto &row : course.table) row[1] /= area;
  }
  return {};
}

std::string resolve_inlet_generator(const Config &config, int d, int high, BoundaryCondition *side) {
  const double length = config.openings[d][high].generator_length, h = config.grid.length[d] / config.grid.cells[d];
  constexpr int least = 8, left = 8;  // cells
  if (length == 0) return {};
  const std::string name = "-boundary_" + side_name(d, high) + "_generator_length: ";
  const double cells = std::round(length / h), most = config.grid.cells[d] - left;
  if (cells < least || cells > most)
    return name + to_text(length) + " is " + to_text(length / h) + " cells; accepted: from " + to_text(least) + " to " +
           to_text(most) + " of the " + to_text(config.grid.cells[d]) + " along the box";
  if (std::fabs(length / h - cells) > 1e-6 * cells)
    return name + to_text(length) + " is " + to_text(length / h) + " cells; accepted: a whole number, such as " +
           to_text(cells * h);
  if (!config.species.empty() && !config.body_series)
    return name + "bodies that enter must be labelled; accepted: -body_series true";
  side->generator_cells = static_cast<int>(cells);
  return {};
}

// Without a capacitance, or without a resistance in parallel to it, the Windkessel has no pressure of its own: the
// limit of small values.
std::string resolve_load(const OpeningSpec &spec, const std::string &name, OutletLoad *load) {
  const auto &[first, capacity, second] = spec.windkessel;
  const bool holds = capacity > 0 && second > 0;
  if (!holds && spec.windkessel_start != 0)
    return name +
           "_windkessel_initial_pressure: the Windkessel has no capacitance with a parallel resistance; accepted: 0, "
           "or both in " +
           name + "_windkessel";
  if (spec.resistance > 0 && spec.windkessel != Real3{})
    return name + "_resistance: given beside " + name + "_windkessel; accepted: one of them";
  *load = {spec.resistance + first, 0, 0, 0};
  if (holds) *load = {first, capacity, second, spec.windkessel_start};
  if (capacity == 0) load->resistance += second;
  return {};
}

}  // namespace

std::string resolve_openings(Config *config) {
  for (int d = 0; d < 3; ++d)
    for (int high = 0; high < 2; ++high) {
      BoundaryCondition &side = config->sides[d][high];
      const bool bounded = config->boundary.bounded(d);
      side.kind = bounded ? config->boundary.kind(d, high) : BoundaryKind::wall;
      config->grid.open[d][high] = bounded && is_open(side.kind);
      if (side.kind == BoundaryKind::inflow)
        for (const auto resolve : {resolve_inflow, resolve_inlet_generator})
          if (std::string wrong = resolve(*config, d, high, &side); !wrong.empty()) return wrong;
      if (side.kind == BoundaryKind::wall)
        if (std::string wrong = resolve_wall(*config, d, high, &side); !wrong.empty()) return wrong;
      if (side.kind != BoundaryKind::pressure) continue;
      const OpeningSpec &spec = config->openings[d][high];
      side.given = {0, 0, 0, {}};
      const std::string name = "-boundary_" + side_name(d, high), option = name + "_pressure";
      if (std::string wrong = resolve_load(spec, name, &side.load); !wrong.empty()) return wrong;
      if (std::string wrong = read_course(spec.pressure, &side.given); !wrong.empty()) return option + ": " + wrong;
      if (std::string wrong = extend_table(spec, name, option, spec.pressure, config->time.end, &side.given);
          !wrong.empty())
        return wrong;
    }
  return has_open_boundary(config->sides) ? std::string() : check_inflow_balance(*config);
}

// The profile of the inflow: 0 in rigid bodies; a developed one is the steady flow along a pipe of that section, -lap u
// = 1 on the open cells of the boundary with u = 0 on walls and surfaces.

namespace {

using MatHandle = Handle<Mat, MatDestroy>;
using KspHandle = Handle<KSP, KSPDestroy>;

// The two directions of a side of direction d, x before y before z.
struct SidePlane {
  int a, b;
  explicit SidePlane(int d) : a(d == 0 ? 1 : 0), b(d == 2 ? 1 : 2) {}
};

// The neighbour of cell (i, j) beyond its face `high` in direction e: another cell, or a wall, where u is odd, or
// neither.
struct Beyond {
  bool cell = false, wall = false;
  int index = 0;
};

Beyond beyond(const Config &config, int e, int i, bool high) {
  const int n = config.grid.cells[e], next = high ? i + 1 : i - 1;
  if (n == 1 && config.grid.boundary[e] == Boundary::periodic) return {};
  if (config.grid.boundary[e] == Boundary::periodic) return {true, false, (next + n) % n};
  if (next >= 0 && next < n) return {true, false, next};
  const BoundaryKind kind = config.sides[e][high].kind;
  return {false, kind == BoundaryKind::wall || kind == BoundaryKind::inflow, 0};
}

// Cells of a boundary that no rigid body covers, and their links (RigidFaces::Cut) low, high along a, then b; 0: a
// regular one.
struct OpenCells {
  static constexpr int values = 5;
  std::vector<double> all;
  bool open(std::size_t cell) const { return all[values * cell] > 0; }
  double link(std::size_t cell, int which, bool high) const { return all[values * cell + 1 + 2 * which + high]; }
};

// Collective.
PetscErrorCode find_open_cells(const Config &config, const Domain &domain, const RigidFaces *rigid, int d, bool high,
                               OpenCells *cells) {
  const SidePlane plane(d);
  const int na = config.grid.cells[plane.a], nb = config.grid.cells[plane.b];
  const Int3 &begin = domain.layout().begin;
  PetscFunctionBeginUser;
  cells->all.assign(std::size_t(OpenCells::values) * na * nb, 0);
  if (!rigid) {
    for (std::size_t v = 0; v < cells->all.size(); v += OpenCells::values) cells->all[v] = 1;
    PetscFunctionReturn(0);
  }
  const auto values = [&](const Int3 &local) {
    const std::size_t cell = (begin[plane.a] + local[plane.a]) + std::size_t(na) * (begin[plane.b] + local[plane.b]);
    return cells->all.data() + OpenCells::values * cell;
  };
  for (const Segment &faces : domain.boundary_faces(d, high)) {
    const RigidFaces::Row row = rigid->row(d, faces.j, faces.k);
    for (int i = faces.i_begin; i < faces.i_end; ++i) {
      double *cell = values({i, faces.j, faces.k});
      cell[0] = 1;
      for (const RigidFaces::Run &run : row.runs)
        if (i >= run.begin && i < run.end) cell[0] = 0;
      for (const RigidFaces::Cut &cut : row.cuts)
        for (const int which : {0, 1})
          for (const bool up : {false, true})
            if (const int link = 2 * (which == 0 ? plane.a : plane.b) + up; cut.i == i && (cut.walls >> link & 1U))
              cell[1 + 2 * which + up] = cut.link[link];
    }
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, cells->all.data(), static_cast<int>(cells->all.size()), MPI_DOUBLE, MPI_SUM,
                             domain.comm()));
  PetscFunctionReturn(0);
}

// The share of a boundary that no rigid body covers, from the solid fractions of the cells beside it. Collective.
PetscErrorCode measure_open_part(const Domain &domain, const std::vector<Phase> &phases, int d, bool high,
                                 double *part) {
  PetscFunctionBeginUser;
  ExactSums covered(1);
  for_points(domain.boundary_cells(d, high, 1), [&](int i, int j, int k) {
    double solid = 0;
    for (const Phase &phase : phases)
      if (phase.material.is_rigid()) solid += phase.fraction[0](i, j, k);
    covered.add(0, std::min(1.0, solid));
  });
  double sum;
  PetscCall(covered.reduce(domain.comm(), &sum));
  *part = 1 - sum / (domain.domain_cell_count() / domain.domain_cells()[d]);
  PetscFunctionReturn(0);
}

PetscErrorCode assemble(const Config &config, int d, const OpenCells &cells, Mat matrix, bool *held) {
  const SidePlane plane(d);
  const int n[2] = {config.grid.cells[plane.a], config.grid.cells[plane.b]};
  PetscFunctionBeginUser;
  *held = false;
  for (int j = 0; j < n[1]; ++j)
    for (int i = 0; i < n[0]; ++i) {
      const PetscInt row = i + PetscInt(n[0]) * j;
      if (!cells.open(row)) {
        PetscCall(MatSetValue(matrix, row, row, 1, ADD_VALUES));
        continue;
      }
      double diagonal = 0;
      for (const int which : {0, 1}) {
        const int e = which == 0 ? plane.a : plane.b;
        const double h = config.grid.spacing(e), coupling = 1 / (h * h);
        for (const bool high : {false, true}) {
          const Beyond other = beyond(config, e, which == 0 ? i : j, high);
          const PetscInt column = which == 0 ? other.index + PetscInt(n[0]) * j : i + PetscInt(n[0]) * other.index;
          const double link = cells.link(row, which, high);
          *held = *held || link > 0 || other.wall;
          diagonal += link > 0 ? link : other.wall ? 2 * coupling : other.cell ? coupling : 0;
          if (other.cell && !(link > 0)) PetscCall(MatSetValue(matrix, row, column, -coupling, ADD_VALUES));
        }
      }
      PetscCall(MatSetValue(matrix, row, row, diagonal, ADD_VALUES));
    }
  PetscCall(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}

PetscErrorCode develop(const Config &config, int d, const OpenCells &open, InflowProfile *profile) {
  const SidePlane plane(d);
  const PetscInt cells = PetscInt(config.grid.cells[plane.a]) * config.grid.cells[plane.b];
  MatHandle matrix;
  KspHandle solver;
  VecHandle force, flow;
  PC pc;
  bool held;
  PetscFunctionBeginUser;
  PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, cells, cells, 5, nullptr, matrix.put()));
  PetscCall(MatSetOption(matrix.get(), MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  PetscCall(assemble(config, d, open, matrix.get(), &held));
  if (!held) PetscFunctionReturn(0);
  std::vector<double> one(cells);
  for (PetscInt cell = 0; cell < cells; ++cell) one[cell] = open.open(cell);
  profile->assign(cells, 0);
  PetscCall(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, cells, one.data(), force.put()));
  PetscCall(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, cells, profile->data(), flow.put()));
  PetscCall(KSPCreate(PETSC_COMM_SELF, solver.put()));
  PetscCall(KSPSetOperators(solver.get(), matrix.get(), matrix.get()));
  PetscCall(KSPSetType(solver.get(), KSPPREONLY));
  PetscCall(KSPGetPC(solver.get(), &pc));
  PetscCall(PCSetType(pc, PCLU));
  PetscCall(KSPSolve(solver.get(), force.get(), flow.get()));
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode shape_profiles(const Config &config, const Domain &domain, const RigidFaces *rigid,
                              const std::vector<Phase> &phases, BoundaryConditions *sides, std::string *wrong) {
  PetscFunctionBeginUser;
  for (int d = 0; d < 3; ++d)
    for (const bool high : {false, true}) {
      BoundaryCondition &side = (*sides)[d][high];
      const bool developed = config.openings[d][high].profile == "developed";
      if (side.kind != BoundaryKind::inflow || !(developed || rigid)) continue;
      OpenCells open;
      PetscCall(find_open_cells(config, domain, rigid, d, high, &open));
      InflowProfile profile;
      if (developed) PetscCall(develop(config, d, open, &profile));
      if (profile.empty() && side.profile) profile = *side.profile;
      if (profile.empty()) profile.assign(open.all.size() / OpenCells::values, 1);
      double sum = 0;
      for (std::size_t cell = 0; cell < profile.size(); ++cell) sum += profile[cell] *= open.open(cell);
      if (!(std::fabs(sum) > 0)) {
        *wrong = "-boundary_" + side_name(d, high) +
                 ": rigid bodies cover all of this inflow boundary; accepted: a boundary that is partly open";
        PetscFunctionReturn(0);
      }
      // The values of a profile alone are the velocity. A flow rate applies to the whole boundary, a velocity is the
      // mean over its open part.
      double part = 1;
      if (!config.openings[d][high].velocity.empty()) PetscCall(measure_open_part(domain, phases, d, high, &part));
      const OpeningSpec &opening = config.openings[d][high];
      const bool is_velocity =
          !developed && !opening.profile.empty() && opening.velocity.empty() && opening.flow_rate.empty();
      for (double &value : profile) value *= is_velocity ? 1 : part * double(profile.size()) / sum;
      side.profile = std::make_shared<const InflowProfile>(std::move(profile));
    }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
