// summary.json: what a run was and what came out of it, for scripts.
#pragma once

#include "base/petsc.hpp"
#include "io/body_record.hpp"

#include <cstdint>
#include <vector>

namespace eulastic {

/// See docs/outputs.md for every key. Rates are derived on writing.
struct Summary {
  std::string method, pressure_solver;
  std::string exit_reason;  ///< time_end, steps, signal, wall_limit, nonfinite, guard, or unfinished
  std::string checkpoint;   ///< file, in the same directory, that the run can go on from; empty = none
  long cells = 0, ranks = 1, threads = 1, steps = 0;
  double time = 0, dt_mean = 0;
  double wall_seconds = 0;  ///< time loop without output
  double wall_seconds_total = 0;
  double bytes_per_cell = 0, active_fraction = 1;
  double acm_sweeps_per_step = 0, ksp_iterations_per_step = 0, viscous_stages_per_step = 0;
  long strain_forgotten = 0;
  double divergence_rms = 0, divergence_max = 0, mach_max = 0, volume_drift = 0;
  double kinetic_energy = 0, elastic_energy = 0, bulk_velocity = 0;
  double viscous_dissipation = 0, force_power = 0, wall_power = 0, elastic_power = 0;  ///< rates at the end
  double energy_supplied = 0, energy_dissipated = 0, energy_lost = 0, energy_lost_elastic = 0, energy_lost_extended = 0;
  double energy_made_share = 0;
  double surface_energy = 0, surface_power = 0, side_power = 0;
  std::uint64_t state_hash = 0;
  struct FileRecord {
    std::string option, path, content;
  };
  std::vector<FileRecord> files;  ///< that options name, and hashes of what they contain
  struct SideRecord {
    std::string side;
    double flow_rate, pressure;
  };
  std::vector<SideRecord> sides;  ///< that volume crosses
  struct Verdict {
    std::string of, verdict, why;
  };
  std::vector<Verdict> verdicts;  ///< on the results: fine, look, or do not trust
  static constexpr int most_bodies = 500;
  std::vector<BodyRecord> bodies;  ///< the first of them
};

std::string summary_text(const Summary &summary);
/// Collective; rank 0's summary counts.
PetscErrorCode write_summary(MPI_Comm comm, const std::string &path, const Summary &summary);

}  // namespace eulastic
