// Former names of options, which are refused with the present ones.
#pragma once

#include <string>
#include <vector>

namespace eulastic {

/// Names without the dash, with SIDE for xmin, ..., zmax and NAME for a species.
struct RenamedOption {
  std::string former, now;
};

const std::vector<RenamedOption> &renamed_options();

/// The present name of an option, given its former one, both without the dash; empty if `name` is not a former name.
std::string present_name(const std::string &name);

}  // namespace eulastic
