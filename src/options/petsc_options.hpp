// Options that are passed to PETSc unread.
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

/// Returns an error of one line about the value of that option, or nothing. A file that PETSc would write must not
/// exist, nor have the name of a file of the run in `output_directory`.
std::string check_petsc_value(const std::string &name, const std::string &value, const std::string &output_directory);

/// Names without dashes, and their values, which may be empty.
using PetscOptionValues = std::map<std::string, std::string>;
/// The command line of these options, program name excluded, for PetscInitialize: -skip_petscrc comes first.
std::vector<std::string> petsc_arguments(const PetscOptionValues &options);
/// Collective; after everything has been set up. `refusal`: one line about an option that no rank's PETSc has read.
/// Options that only print are exempt: PETSc reads them during the solution or at the end.
PetscErrorCode find_unread_option(const PetscOptionValues &options, std::string *refusal);

}  // namespace eulastic
