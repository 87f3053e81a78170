// -initial_state: fields of the start from an HDF5 file, each at its own staggered place; a snapshot is such a file.
//
// What the file does not hold stays as the other options made it. With a solid fraction it also says which bodies
// there are: those of `body`, or one per species.
#pragma once

#include "base/petsc.hpp"
#include "bodies/placement.hpp"
#include "grid/domain.hpp"
#include "io/hdf5_file.hpp"
#include "parts/state.hpp"
#include "scene/config.hpp"

namespace eulastic {

class InitialState {
public:
  InitialState(const Config &config, const Domain &domain) : config_(&config), domain_(&domain) {}

  // All members are collective. What is wrong with the file is an error of fail_together().

  /// Opens the file and refuses datasets that nobody reads. Without -initial_state nothing is read at all.
  PetscErrorCode open();
  PetscErrorCode read_flow(State *state);
  /// Whether the file has the solid fraction or B of a species.
  bool holds(const SpeciesSpec &species) const;
  /// Fraction, B and labels of one species; `places`: the bodies as placed, replaced by those of the file, labels
  /// `first_label` and following.
  PetscErrorCode read_phase(const SpeciesSpec &species, int first_label, Phase *phase, Places *places);
  /// Whether any bodies came from the file: then their centres in `places` are just some cell of theirs.
  bool has_bodies() const { return has_bodies_; }

private:
  enum class Wanted { finite, positive, fraction, label };
  PetscErrorCode check_names();
  std::string name_for(const std::string &base, const SpeciesSpec &species) const;
  PetscErrorCode read(const std::string &name, const Staggering &staggering, Wanted wanted, View field);
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
