#include "app/petsc_options.hpp"

#include <algorithm>

namespace eulastic {

// -options_file is not among them: what it brings in would escape our checks.
const std::vector<std::string> &petsc_option_names() {
  static const std::vector<std::string> names{"log_",
                                              "ksp_",
                                              "pc_",
                                              "mat_",
                                              "vec_",
                                              "sf_",
                                              "dm_",
                                              "is_",
                                              "malloc_",
                                              "fp_",
                                              "memory_",
                                              "on_error_",
                                              "viewer_",
                                              "debugger_",
                                              "pressure_ksp_",
                                              "pressure_pc_",
                                              "info",
                                              "malloc",
                                              "options_left",
                                              "options_view",
                                              "options_monitor",
                                              "citations",
                                              "fp_trap",
                                              "no_signal_handler",
                                              "skip_petscrc",
                                              "start_in_debugger"};
  return names;
}

bool is_petsc_option(const std::string &name) {
  const auto &known = petsc_option_names();
  return std::any_of(known.begin(), known.end(), [&](const std::string &k) {
    return k.back() == '_' ? name.size() > k.size() && name.compare(0, k.size(), k) == 0 : name == k;
  });
}

}  // namespace eulastic
