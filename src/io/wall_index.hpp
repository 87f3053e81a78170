// walls.xdmf: the planes of cells on the walls in each snapshot, for ParaView.
#pragma once

#include "io/snapshot.hpp"

namespace eulastic {

/// The index of the fields on walls (SnapshotField with a plane) in all snapshots `entries`; empty if there are none.
std::string wall_index(const Box &box, const std::vector<SnapshotEntry> &entries,
                       const std::vector<SnapshotField> &fields);

}  // namespace eulastic
