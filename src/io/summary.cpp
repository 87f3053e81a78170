#include "io/summary.hpp"

#include "io/checksum.hpp"
#include "io/json.hpp"
#include "io/text_file.hpp"

namespace eulastic {

namespace {

Json body_json(const BodyRecord &b) {
  Json json;
  json.add("id", b.id).add("species", b.species);
  for_numbers(b, true, true, false, [&](const char *name, const auto &value) { json.add(name, value); });
  return json;
}

}  // namespace

std::string summary_text(const Summary &s) {
  std::vector<Json> bodies, sides, files, verdicts;
  for (const BodyRecord &b : s.bodies) bodies.push_back(body_json(b));
  for (const Summary::SideRecord &side : s.sides)
    sides.push_back(Json().add("side", side.side).add("flow_rate", side.flow_rate).add("pressure", side.pressure));
  for (const Summary::FileRecord &file : s.files)
    files.push_back(Json().add("option", file.option).add("path", file.path).add("content", file.content));
  for (const Summary::Verdict &v : s.verdicts)
    verdicts.push_back(Json().add("of", v.of).add("verdict", v.verdict).add("why", v.why));
  const double updates = double(s.cells) * double(s.steps);
  return Json()
      .add("version", std::string(EULASTIC_VERSION))
      .add("method", s.method)
      .add("pressure_solver", s.pressure_solver)
      .add("exit_reason", s.exit_reason)
      .add("checkpoint", s.checkpoint)
      .add("cells", s.cells)
      .add("ranks", s.ranks)
      .add("threads", s.threads)
      .add("steps", s.steps)
      .add("time", s.time)
      .add("dt_mean", s.dt_mean)
      .add("wall_seconds", s.wall_seconds)
      .add("wall_seconds_total", s.wall_seconds_total)
      .add("cell_updates_per_second", updates / s.wall_seconds)
      .add("ns_per_cell_step", 1e9 * s.wall_seconds / updates)
      .add("bytes_per_cell", s.bytes_per_cell)
      .add("active_fraction", s.active_fraction)
      .add("acm_sweeps_per_step", s.acm_sweeps_per_step)
      .add("ksp_iterations_per_step", s.ksp_iterations_per_step)
      .add("viscous_stages_per_step", s.viscous_stages_per_step)
      .add("strain_forgotten", s.strain_forgotten)
      .add("divergence_rms", s.divergence_rms)
      .add("divergence_max", s.divergence_max)
      .add("mach_max", s.mach_max)
      .add("volume_drift", s.volume_drift)
      .add("kinetic_energy", s.kinetic_energy)
      .add("elastic_energy", s.elastic_energy)
      .add("viscous_dissipation", s.viscous_dissipation)
      .add("force_power", s.force_power)
      .add("wall_power", s.wall_power)
      .add("elastic_power", s.elastic_power)
      .add("energy_supplied", s.energy_supplied)
      .add("energy_dissipated", s.energy_dissipated)
      .add("energy_lost", s.energy_lost)
      .add("energy_lost_elastic", s.energy_lost_elastic)
      .add("energy_lost_extended", s.energy_lost_extended)
      .add("energy_made_share", s.energy_made_share)
      .add("surface_energy", s.surface_energy)
      .add("surface_power", s.surface_power)
      .add("side_power", s.side_power)
      .add("files", files)
      .add("sides", sides)
      .add("verdicts", verdicts)
      .add("bulk_velocity", s.bulk_velocity)
      .add("state_hash", checksum_text(s.state_hash))
      .add("bodies", bodies)
      .text();
}

PetscErrorCode write_summary(MPI_Comm comm, const std::string &path, const Summary &summary) {
  return write_text_file(comm, path, summary_text(summary));
}

}  // namespace eulastic
