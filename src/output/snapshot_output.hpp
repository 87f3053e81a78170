// Snapshots of a run: fields of the state, and stresses on walls and surfaces.
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"
#include "io/snapshot.hpp"
#include "io/snapshot_fields.hpp"
#include "scene/config.hpp"
#include "solver/solver.hpp"

namespace eulastic {

class SnapshotOutput {
public:
  SnapshotOutput(const Domain &domain, const std::string &directory, bool vti)
      : writer_(domain, directory, vti), fields_(domain) {}

  /// As SnapshotWriter's.
  PetscErrorCode resume(int count, bool same_directory) { return writer_.resume(count, same_directory); }
  void moved_to(const std::string &directory) { writer_.moved_to(directory); }
  int count() const { return writer_.count(); }
  /// Writes a snapshot of the present state, which is not changed. Collective.
  PetscErrorCode write(const Config &config, Solver *solver);

private:
  PetscErrorCode write_fields(const Config &config, Solver *solver, const std::vector<Phase> &phases);
  SnapshotWriter writer_;
  SnapshotFields fields_;
};

}  // namespace eulastic
