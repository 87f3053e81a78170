// Files of single bonds of a run with adhesion: adhesion_bonds.csv, adhesion_events.csv.
#pragma once

#include "adhesion/adhesion.hpp"
#include "io/series.hpp"

namespace eulastic {

class BondFiles {
public:
  /// Rows in the files.
  struct Position {
    std::int64_t bonds = 0, events = 0;
  };
  /// Collective. At a restart in the same directory its files are cut back to `position`.
  PetscErrorCode open(MPI_Comm comm, const std::string &directory, const Position &position);
  void moved_to(const std::string &directory);
  /// Collective. A row for every event since the last call.
  PetscErrorCode write_events(Adhesion *adhesion);
  /// Collective. A row for every bond.
  PetscErrorCode write_bonds(double time, const Adhesion &adhesion);
  PetscErrorCode sync(Position *position);

private:
  Series bonds_, events_;
};

}  // namespace eulastic
