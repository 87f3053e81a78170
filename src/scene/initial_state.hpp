// -initial_state: reads initial fields from an HDF5 file, each at its staggered position; a snapshot is such a file.
//
// Fields that the file lacks keep the values of the other options. A solid fraction also defines the bodies: those of
// the dataset `body`, or one per species.
#pragma once

#include "base/petsc.hpp"
#include "bodies/placement.hpp"
#include "grid/domain.hpp"
#include "io/hdf5_file.hpp"
#include "parts/state.hpp"
#include "scene/config.hpp"

namespace eulastic {

/// The values that a dataset may have.
struct AcceptedValues {
  const char *text;
  bool (*has)(double value);
};

class InitialState {
public:
  InitialState(const Config &config, const Domain &domain) : config_(&config), domain_(&domain) {}

  // All members are collective. Errors of the file are reported by fail_together().

  /// Opens the file and refuses unknown datasets. Without -initial_state nothing is read.
  PetscErrorCode open();
  PetscErrorCode read_flow(State *state);
  /// Whether the file has the solid fraction or B of a species.
  bool holds(const SpeciesSpec &species) const;
  /// Reads fraction, B and labels of one species. `places`: the positions of its bodies, replaced by those of the file;
  /// labels begin at `first_label`.
  PetscErrorCode read_phase(const SpeciesSpec &species, int first_label, Phase *phase, Places *places);
  /// Whether any bodies came from the file: their centres in `places` are then an arbitrary cell of each.
  bool has_bodies() const { return has_bodies_; }

private:
  PetscErrorCode check_names();
  std::string name_for(const std::string &base, const SpeciesSpec &species) const;
  PetscErrorCode read(const std::string &name, const Staggering &staggering, const AcceptedValues &accepted,
                      View field);
  PetscErrorCode read_constant(const std::string &name, double value);
  PetscErrorCode read_tensor(const SpeciesSpec &species, Phase *phase);
  PetscErrorCode read_bodies(const SpeciesSpec &species, int first_label, Phase *phase, Places *places);
  PetscErrorCode find_bodies(int first_label, int bodies, const Phase &phase, Places *places) const;
  PetscErrorCode fail(const std::string &problem) const;

  const Config *config_;
  const Domain *domain_;
  Hdf5File file_;
  bool open_ = false, has_bodies_ = false;
};

}  // namespace eulastic
