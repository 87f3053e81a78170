#include "options/option_rows.hpp"

namespace eulastic {
namespace {

const Names boundary_names{"periodic", "wall", "symmetry"};
const Names side_names{"same", "wall", "symmetry", "inflow", "pressure", "outflow"};
const char *const number_or_table = "a number, or a path to a table of time,value";

void add_kinds(Rows &rows, Config &config) {
  rows.group = "Boundaries";
  for (int d = 0; d < 3; ++d)
    rows.choice(std::string("boundary_") + "xyz"[d], config.boundary.both[d], boundary_names,
                std::string("kind of both boundaries in ") + "xyz"[d] +
                    "; wall: no slip; symmetry: no flow through it and no shear stress");
  for (int d = 0; d < 3; ++d)
    for (int high = 0; high < 2; ++high)
      rows.choice(
          std::string("boundary_") + "xyz"[d] + (high ? "max" : "min"), config.boundary.side[d][high], side_names,
          "kind of this boundary alone; same: the kind that -boundary_x, -boundary_y or -boundary_z gives to both; "
          "wall: no slip; symmetry: no flow through it and no shear stress; inflow: the velocity is prescribed; "
          "pressure: the pressure is prescribed; outflow: pressure 0, and no energy enters where fluid flows back");
}

bool is_number(const std::string &text) {
  double number;
  return read_numbers(text, any_number, &number, 1).empty();
}

bool is_vector(const std::string &text) {
  Real3 vector;
  return read_numbers(text, any_number, vector.data(), 3).empty();
}

// The rows of one boundary. Each is accepted only on boundaries of some kinds.
struct BoundaryRows {
  Rows &rows;
  Config &config;
  OpeningSpec &spec;
  int d, high;

  void add_velocity() const {
    only_on({BoundaryKind::wall, BoundaryKind::inflow}, "wall or inflow");
    Option &row =
        rows.add("velocity", "length/time",
                 "for a wall its velocity, whose normal component must be 0; for an inflow the mean velocity into the "
                 "box over the open area; a number is multiplied by cos(angular_frequency t + phase)");
    row.accepted = std::string("for a wall 3 numbers, separated by commas; for inflow ") + number_or_table;
    row.default_note = "0,0,0 for a wall; an inflow requires it or the flow rate, unless the profile is a file";
    row.names_file = [](const std::string &value) { return !is_number(value) && !is_vector(value); };
    row.read = [&spec = spec](const std::string &value) { return read_text(value, &spec.velocity); };
    row.text = [&config = config, &spec = spec, d = d, high = high] {
      Real3 of_wall{};
      if (config.boundary.is(BoundaryKind::inflow, d, high)) return spec.velocity;
      if (!spec.velocity.empty() && !read_numbers(spec.velocity, any_number, of_wall.data(), 3).empty())
        return spec.velocity;
      return list(of_wall.data(), 3);
    };
    rows.oscillation("", spec.frequency, spec.phase, " of the velocity or the flow rate");
  }

  void add_inflow() const {
    only_on({BoundaryKind::inflow}, "inflow");
    number_or_file("flow_rate", spec.flow_rate, "volume/time",
                   "flow rate into the box, given instead of the velocity; in 2-D per unit depth");
    Option &profile = rows.path("profile", spec.profile,
                                "profile of the velocity into the box; uniform: the same velocity everywhere; "
                                "developed: that of a steady flow in a duct with this cross-section; a path: one "
                                "number per cell of the boundary, from a text or HDF5 file (docs/howto/vessel.md)");
    profile.accepted = "uniform, developed, or a path, of HDF5 also FILE:DATASET";
    profile.names_file = [](const std::string &value) { return value != "uniform" && value != "developed"; };
    rows.real("generator_length", spec.generator_length, not_negative, "length",
              "length of the inlet generator, a stretch of the box beside the boundary: bodies and flow that pass its "
              "end also enter through the boundary; off: no inlet generator");
    rows.zero_is("off");
  }

  void add_pressure() const {
    only_on({BoundaryKind::pressure}, "pressure");
    number_or_file("pressure", spec.pressure, "pressure", "prescribed pressure at the boundary");
    rows.real("resistance", spec.resistance, not_negative, "pressure time/volume",
              "resistance of the vessels behind the boundary: the pressure at the boundary increases by this value "
              "times the flow rate out of the box");
    rows.real("windkessel", spec.windkessel, not_negative, "",
              "three-element Windkessel R1,C,R2 behind the boundary: a resistance R1 (pressure time/volume), in series "
              "with a capacitance C (volume/pressure) and a resistance R2 in parallel; 0,0,0: none");
    rows.real("windkessel_initial_pressure", spec.windkessel_start, any_number, "pressure",
              "pressure of the capacitance C of the Windkessel at t = 0");
  }

  void add_table_ends() const {
    only_on({BoundaryKind::inflow, BoundaryKind::pressure}, "inflow or pressure");
    rows.may_change = true;
    rows.real("table_period", spec.period, not_negative, "time",
              "period after which the table of the velocity, flow rate or pressure repeats (docs/howto/numbers.md); "
              "off: it does not repeat");
    rows.zero_is("off");
    rows.boolean("table_hold", spec.hold,
                 "whether the first value of the table holds before its first time, and the last value after its last "
                 "time; false: the table must cover the run");
    rows.may_change = false;
  }

private:
  // A number, or a table over time.
  void number_or_file(const std::string &name, std::string &target, const std::string &unit,
                      const std::string &doc) const {
    Option &row = rows.path(name, target, doc);
    row.unit = unit;
    row.accepted = number_or_table;
    row.names_file = [](const std::string &value) { return !is_number(value); };
  }

  // The rows that follow are accepted only on boundaries of these kinds.
  void only_on(const std::vector<BoundaryKind> &kinds, const std::string &names) const {
    const std::string side = std::string{"xyz"[d]};
    std::string needed = "-boundary_" + side + (high ? "max " : "min ") + names;
    if (kinds[0] == BoundaryKind::wall) needed += ", or -boundary_" + side + " wall";
    rows.limit(needed, [&config = config, kinds, d = d, high = high] {
      return std::any_of(kinds.begin(), kinds.end(),
                         [&](BoundaryKind kind) { return config.boundary.is(kind, d, high); });
    });
  }
};

}  // namespace

void add_boundaries(Rows &rows, Config &config) {
  add_kinds(rows, config);
  for (int d = 0; d < 3; ++d)
    for (int high = 0; high < 2; ++high) {
      rows.prefix = "boundary_" + side_name(d, high != 0) + "_";
      const BoundaryRows side{rows, config, config.openings[d][high], d, high};
      side.add_velocity();
      side.add_inflow();
      side.add_pressure();
      side.add_table_ends();
    }
  rows.prefix.clear();
  rows.end_limit();
}

}  // namespace eulastic
