// Snapshots of a run: fields of the state, and stresses on walls and surfaces.
#pragma once

#include "base/petsc.hpp"
#include "io/snapshot.hpp"
#include "scene/config.hpp"
#include "solver/solver.hpp"

namespace eulastic {

/// Writes a snapshot of the present state, which is not changed. Collective.
PetscErrorCode write_snapshot(const Config &config, Solver *solver, SnapshotWriter *writer);

}  // namespace eulastic
