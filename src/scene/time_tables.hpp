// Numbers over time that the user gives as a table.
#pragma once

#include "scene/config.hpp"

namespace eulastic {

/// Reads a number; or from a file a table of rows time,value, whose times ascend, and the period that a line
/// "# period T" gives it. Collective. Returns an error text, or nothing.
std::string read_course(const std::string &text, TimeCourse *course);
/// Lets a table repeat as it or `spec` says, or refuses one that does not reach from 0 to the end of the run without
/// being held. `side`: "-boundary_xmin"; `option`: the one that names `file`, the table. Returns one line, or nothing.
std::string extend_table(const OpeningSpec &spec, const std::string &side, const std::string &option,
                         const std::string &file, double end, TimeCourse *course);

}  // namespace eulastic
