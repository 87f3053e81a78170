#include "options/option_rows.hpp"

namespace eulastic {
namespace {

// The rows from `first` on mean something only on sides of that kind.
void only_on(Rows &rows, std::size_t first, Config &config, SideKind kind, const std::string &side, int d, int high) {
  rows.limit(first, "-boundary_" + side + (kind == SideKind::inflow ? " inflow" : " pressure"),
             [&config, kind, d, high] { return config.boundary.is(kind, d, high); });
}

// What happens where a table of the side ends.
void add_table_ends(Rows &rows, OpeningSpec &spec, const std::string &name) {
  const std::size_t first = rows.rows.size();
  rows.real(name + "_period", spec.period, not_negative, "time",
            "period after which the table repeats (docs/howto/numbers.md); 0 = it does not repeat");
  rows.boolean(name + "_hold", spec.hold,
               "whether a table that does not cover the run is continued by its first and its last value");
  rows.allow_change(first);
}

void add_inflow(Rows &rows, Config &config, const std::string &side, int d, int high) {
  OpeningSpec &spec = config.openings[d][high];
  const std::string name = "inflow_" + side;
  const std::size_t first = rows.rows.size();
  Option &profile =
      rows.path(name + "_profile", spec.profile,
                "profile of the velocity into the box: uniform; developed, that of a steady duct flow; or one "
                "number per cell of the boundary, from a text or HDF5 file (docs/howto/vessel.md)");
  profile.accepted = "uniform, developed, or a path, of HDF5 also FILE:DATASET";
  profile.names_file = [](const std::string &value) { return value != "uniform" && value != "developed"; };
  for (const bool flow : {false, true}) {
    std::string &target = flow ? spec.flow_rate : spec.velocity;
    Option &row = rows.path(name + (flow ? "_flow_rate" : "_velocity"), target,
                            flow ? "flow rate into the box, in 2-D per depth; a file gives it over time"
                                 : "mean velocity into the box over the open area; a file gives it over time");
    row.unit = flow ? "volume/time" : "length/time";
    row.accepted = "a number, or a path to a table of time,value";
    row.default_note = flow ? "" : "this or the flow rate is required, unless the profile is a file";
    row.names_file = [](const std::string &value) {
      double number;
      return !read_reals(value, any_number, &number, 1).empty();
    };
  }
  rows.real(name + "_frequency", spec.frequency, not_negative, "1/time",
            "angular frequency w of the factor cos(w t + phase)");
  rows.real(name + "_phase", spec.phase, any_number, "rad", "phase of that factor");
  rows.real(
      name + "_feeder", spec.feeder, not_negative, "length",
      "length of the inlet generator beside the boundary: bodies and flow that pass its end also enter through the "
      "boundary; 0 = none");
  add_table_ends(rows, spec, name);
  only_on(rows, first, config, SideKind::inflow, side, d, high);
}

void add_pressure(Rows &rows, Config &config, const std::string &side, int d, int high) {
  OpeningSpec &spec = config.openings[d][high];
  const std::size_t first = rows.rows.size();
  rows.real("pressure_" + side + "_value", spec.value, any_number, "pressure", "pressure at the boundary");
  Option &table =
      rows.path("pressure_" + side + "_table", spec.table, "file with the pressure over time, instead of the value");
  table.accepted = "a path to a table of time,value";
  table.names_file = any_file;
  add_table_ends(rows, spec, "pressure_" + side);
  rows.real("pressure_" + side + "_resistance", spec.resistance, not_negative, "pressure time/volume",
            "resistance: the pressure increases by this times the flow rate out of the box");
  rows.real(
      "pressure_" + side + "_windkessel", spec.windkessel, not_negative, "",
      "three-element Windkessel R,C,R: a resistance, then a capacitance (volume/pressure) in parallel with a second "
      "resistance; 0,0,0 = none");
  rows.real("pressure_" + side + "_windkessel_start", spec.windkessel_start, any_number, "pressure",
            "pressure of the capacitance of the Windkessel at t = 0");
  only_on(rows, first, config, SideKind::pressure, side, d, high);
}

}  // namespace

void add_openings(Rows &rows, Config &config) {
  rows.group = "Inflow, pressure and outflow boundaries";
  for (int d = 0; d < 3; ++d)
    for (int high = 0; high < 2; ++high) {
      const std::string side = side_name(d, high);
      add_inflow(rows, config, side, d, high);
      add_pressure(rows, config, side, d, high);
    }
}

}  // namespace eulastic
