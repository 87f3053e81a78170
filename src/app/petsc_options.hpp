// The options that belong to PETSc and pass through to it unread.
#pragma once

#include <petscsystypes.h>

#include <map>
#include <string>
#include <vector>

namespace eulastic {

/// `name` without its dash.
bool is_petsc_option(const std::string &name);
/// Whole names and prefixes (ending in _) that is_petsc_option accepts.
const std::vector<std::string> &petsc_option_names();

/// Whether it belongs to the KSP of -pressure_solver ksp.
bool is_pressure_ksp_option(const std::string &name);

using PetscOptionValues = std::map<std::string, std::string>;
/// Those of the KSP among `petsc_arguments`, without dashes; the last of equal names wins, as in PETSc.
PetscOptionValues pressure_ksp_options(const std::vector<std::string> &petsc_arguments);
/// Collective; after the KSP has been set up. `refusal`: one line about an option that no rank's PETSc has read. What
/// shows things is exempt: PETSc reads that when it solves.
PetscErrorCode find_unread_option(const PetscOptionValues &options, std::string *refusal);

}  // namespace eulastic
