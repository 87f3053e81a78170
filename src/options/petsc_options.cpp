#include "options/petsc_options.hpp"

#include "base/rank_zero.hpp"
#include "io/run_directory.hpp"

#include <petscsys.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <sstream>

namespace eulastic {

// -options_file is not among them: it is ours.
const std::vector<std::string> &petsc_option_names() {
  static const std::vector<std::string> names = [] {
    std::istringstream words(
        "log_view log_view_memory log_all log_trace log_sync log_exclude mat_ vec_ sf_ dm_ is_ malloc_ "
        "fp_ memory_ on_error_ viewer_ debugger_ pressure_ksp_ pressure_pc_ pressure_mg_ pressure_sub_ "
        "pressure_redundant_ info malloc options_left options_view options_monitor citations fp_trap "
        "no_signal_handler skip_petscrc start_in_debugger");
    return std::vector<std::string>(std::istream_iterator<std::string>(words), {});
  }();
  return names;
}

bool is_petsc_option(const std::string &name) {
  const auto &known = petsc_option_names();
  return std::any_of(known.begin(), known.end(), [&](const std::string &k) {
    return k.back() == '_' ? name.size() > k.size() && name.compare(0, k.size(), k) == 0 : name == k;
  });
}

bool is_pressure_ksp_option(const std::string &name) {
  return name.rfind("pressure_", 0) == 0 && is_petsc_option(name);
}

namespace {

namespace fs = std::filesystem;

// Whether PETSc may take (a part of) the value of this option for the name of a file to write.
bool writes_file(const std::string &name) {
  static const std::vector<std::string> parts{"log_",      "info",    "view",     "monitor", "converged_reason",
                                              "citations", "malloc_", "options_", "memory_", "viewer_"};
  return std::any_of(parts.begin(), parts.end(),
                     [&](const std::string &part) { return name.find(part) != std::string::npos; });
}

// FILE, :FILE, TYPE:FILE:FORMAT: what stands between colons; PETSc adds the rank to some names.
std::vector<std::string> possible_files(const std::string &value) {
  std::vector<std::string> files;
  std::istringstream parts(value);
  for (std::string part; std::getline(parts, part, ':');)
    if (!part.empty()) files.insert(files.end(), {part, part + ".0"});
  return files;
}

bool is_of_run(const std::string &file, const std::string &output_directory) {
  std::error_code error;
  const fs::path folder = fs::absolute(file, error).parent_path();
  return is_output_file(fs::path(file).filename()) &&
         fs::weakly_canonical(folder, error) == fs::weakly_canonical(fs::absolute(output_directory, error), error);
}

}  // namespace

std::string check_petsc_value(const std::string &name, const std::string &value, const std::string &output_directory) {
  const bool type = name.size() > 5 && name.compare(name.size() - 5, 5, "_type") == 0;
  for (const char *device : {"cuda", "hip", "kokkos", "viennacl", "sycl", "cusparse"})
    if (type && value.find(device) != std::string::npos)
      return "-" + name + ": \"" + value +
             "\" runs on graphics processors; accepted: types that run on processors, such as standard or aij";
  if (value.empty() || !writes_file(name)) return {};
  // PETSc looks at this one after the run, when it is too late.
  if (name == "log_view" && value[0] != ':' && value.rfind("ascii", 0) != 0)
    return "-log_view: \"" + value +
           "\" is not a viewer; accepted: no value, :FILE or :FILE:ascii_xml, ascii_flamegraph, ...";
  return on_rank_0([&] {
    std::error_code ignored;
    for (const std::string &file : possible_files(value)) {
      const bool of_run = is_of_run(file, output_directory);
      if (of_run || fs::is_regular_file(file, ignored))
        return "-" + name + ": " + file + (of_run ? " is the name of a file of the run" : " exists") +
               "; accepted: the name of a new file";
    }
    return std::string();
  });
}

std::vector<std::string> petsc_arguments(const PetscOptionValues &options) {
  std::vector<std::string> words{"-skip_petscrc"};
  for (const auto &[name, value] : options) {
    words.push_back("-" + name);
    if (!value.empty()) words.push_back(value);
  }
  return words;
}

PetscErrorCode find_unread_option(const PetscOptionValues &options, std::string *refusal) {
  PetscFunctionBeginUser;
  PetscInt count = 0;
  char **names = nullptr, **values = nullptr;
  PetscCall(PetscOptionsLeftGet(nullptr, &count, &names, &values));
  const std::vector<std::string> left(names, names + count);
  PetscCall(PetscOptionsLeftRestore(nullptr, &count, &names, &values));
  for (const auto &[name, value] : options) {
    const auto has = [name = name](const char *part) { return name.find(part) != std::string::npos; };
    if (has("_view") || has("_converged_reason") || has("options_") || name == "citations") continue;
    int unread = static_cast<int>(std::count(left.begin(), left.end(), name));
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, &unread, 1, MPI_INT, MPI_MIN, run_communicator()));  // some on one rank only
    if (!unread || !refusal->empty()) continue;
    *refusal = "-" + name + ": is unknown to PETSc, or unused in this run";
    if (is_pressure_ksp_option(name)) *refusal += " (KSP and PC as chosen); -pressure_ksp_view shows them";
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
