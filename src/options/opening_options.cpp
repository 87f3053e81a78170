#include "options/opening_options.hpp"

namespace eulastic {
namespace {

// The rows from `first` on mean something only on sides of that kind.
void only_on(Rows &rows, std::size_t first, Config &config, SideKind kind, const std::string &side, int d, int high) {
  for (std::size_t r = first; r < rows.rows.size(); ++r) {
    rows.rows[r].only_with = "-boundary_" + side + (kind == SideKind::inflow ? " inflow" : " pressure");
    rows.rows[r].applies = [&config, kind, d, high] { return config.boundary.is(kind, d, high); };
  }
}

// What happens where a table of the side ends.
void add_table_ends(Rows &rows, OpeningSpec &spec, const std::string &name) {
  const std::size_t first = rows.rows.size();
  rows.real(name + "_period", spec.period, not_negative, "time",
            "the table repeats after this time (docs/howto/numbers.md); 0 = never");
  rows.boolean(name + "_hold", spec.hold, "a table that does not cover the run holds its first and its last value");
  rows.allow_change(first);
}

void add_inflow(Rows &rows, Config &config, const std::string &side, int d, int high) {
  OpeningSpec &spec = config.openings[d][high];
  const std::string name = "inflow_" + side;
  const std::size_t first = rows.rows.size();
  Option &profile = rows.path(name + "_profile", spec.profile,
                              "shape of the velocity into the box: uniform; developed, that of a steady flow along the "
                              "side; or one number per cell, of a text or an HDF5 file (docs/howto/vessel.md)");
  profile.accepted = "uniform, developed, or a path, of HDF5 also FILE:DATASET";
  profile.names_file = [](const std::string &value) { return value != "uniform" && value != "developed"; };
  for (const bool flow : {false, true}) {
    std::string &target = flow ? spec.flow_rate : spec.velocity;
    Option &row =
        rows.path(name + (flow ? "_flow_rate" : "_velocity"), target,
                  flow ? "volume into the box per time, in 2-D per depth; over time from a file"
                       : "mean velocity into the box over what rigid bodies leave open; over time from a file");
    row.unit = flow ? "volume/time" : "length/time";
    row.accepted = "a number, or a path to a table of time,value";
    row.default_note = flow ? "" : "this or the flow rate is required, but with a file as profile";
    row.names_file = [](const std::string &value) {
      double number;
      return !read_reals(value, any_number, &number, 1).empty();
    };
  }
  rows.real(name + "_frequency", spec.frequency, not_negative, "1/time",
            "angular frequency: times cos(frequency t + phase)");
  rows.real(name + "_phase", spec.phase, any_number, "rad", "phase");
  rows.real(name + "_feeder", spec.feeder, not_negative, "length",
            "bodies and flow that pass the end of this stretch beside the side come in through it as well; 0 = none");
  add_table_ends(rows, spec, name);
  only_on(rows, first, config, SideKind::inflow, side, d, high);
}

void add_pressure(Rows &rows, Config &config, const std::string &side, int d, int high) {
  OpeningSpec &spec = config.openings[d][high];
  const std::size_t first = rows.rows.size();
  rows.real("pressure_" + side + "_value", spec.value, any_number, "pressure", "pressure on the side");
  Option &table = rows.path("pressure_" + side + "_table", spec.table, "the pressure over time, in place of the value");
  table.accepted = "a path to a table of time,value";
  table.names_file = any_file;
  add_table_ends(rows, spec, "pressure_" + side);
  rows.real("pressure_" + side + "_resistance", spec.resistance, not_negative, "pressure time/volume",
            "the pressure rises by this times the flow rate out of the box");
  rows.real("pressure_" + side + "_windkessel", spec.windkessel, not_negative, "",
            "R,C,R: resistance, then capacity that the second resistance drains (volume/pressure); 0,0,0 = none");
  rows.real("pressure_" + side + "_windkessel_start", spec.windkessel_start, any_number, "pressure",
            "pressure of the capacity of the Windkessel at t = 0");
  only_on(rows, first, config, SideKind::pressure, side, d, high);
}

}  // namespace

void add_openings(Rows &rows, Config &config) {
  rows.group = "Inflow, pressure and outflow sides";
  for (int d = 0; d < 3; ++d)
    for (int high = 0; high < 2; ++high) {
      const std::string side = std::string{"xyz"[d]} + (high ? "max" : "min");
      add_inflow(rows, config, side, d, high);
      add_pressure(rows, config, side, d, high);
    }
}

}  // namespace eulastic
