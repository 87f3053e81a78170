// Everything the user may choose, validated. The member initialisers are the defaults that -help shows.
#pragma once

#include "bodies/species.hpp"
#include "field/walls.hpp"
#include "grid/grid.hpp"
#include "physics/fluid.hpp"
#include "physics/initial_velocity.hpp"
#include "solver/method.hpp"

#include <string>
#include <vector>

namespace eulastic {

struct TimeControl {
  double end = 0;
  double step = 0;     ///< 0 = automatic
  long steps_max = 0;  ///< 0 = no limit
};

struct OutputControl {
  std::string directory = "output";
  bool overwrite = false;
  double snapshot_interval = 0;  ///< simulated time; 0 = no snapshots, else the start and the end are written too
  std::vector<std::string> snapshot_fields{"velocity", "pressure", "solid_fraction", "body"};
  bool snapshot_single = true;  ///< single precision
  double series_interval = 0;   ///< simulated time; after parsing never 0: time_end / 200 unless given
};

struct Config {
  GridSpec grid;
  Walls walls;
  Fluid fluid;
  InitialFlow initial;
  std::vector<SpeciesSpec> species;
  Method method = method_preset(MethodKind::fast);
  TimeControl time;
  OutputControl output;
  bool check_only = false;
};

}  // namespace eulastic
