#include "output/sample_files.hpp"

#include <fstream>

namespace eulastic {
namespace {

// Lines of a table whose time is not after `end`.
long rows_until(const std::string &path, double end) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  long rows = 0;
  while (std::getline(file, line) && std::strtod(line.c_str(), nullptr) <= end) ++rows;
  return rows;
}

}  // namespace

PetscErrorCode SampleFiles::open(const SampleControl &samples, const Domain &domain, const std::string &directory,
                                 double probes_time, double profile_time) {
  PetscFunctionBeginUser;
  domain_ = &domain;
  profile_due_ = {samples.profile_interval, profile_time};
  if (!samples.probes.empty()) PetscCall(add({-1, false, samples.probes, {}}, directory, probes_time));
  for (int d = 0; d < 3; ++d) {
    const ProfileSpec &spec = samples.profile[d];
    if (spec.kind == ProfileSpec::Kind::none) continue;
    std::vector<Real3> points(domain.domain_cells()[d], spec.line);
    for (int n = 0; n < domain.domain_cells()[d]; ++n) points[n][d] = (n + 0.5) * domain.spacing()[d];
    PetscCall(add({d, spec.kind == ProfileSpec::Kind::mean, points, {}}, directory, profile_time));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode SampleFiles::add(File &&of, const std::string &directory, double end) {
  PetscFunctionBeginUser;
  std::vector<std::string> columns{"time"};
  if (of.direction < 0)
    columns.insert(columns.end(), {"probe", "x", "y", "z"});
  else
    columns.push_back(std::string(1, "xyz"[of.direction]));
  columns.insert(columns.end(), {"velocity_x", "velocity_y", "velocity_z", "pressure", "solid_fraction"});
  File &file = files_.emplace_back(std::move(of));
  const std::string path = directory + file.name();
  PetscCall(file.table.open(domain_->comm(), path, columns, domain_->rank() == 0 ? rows_until(path, end) : 0));
  PetscFunctionReturn(0);
}

void SampleFiles::moved_to(const std::string &directory) {
  for (File &file : files_) file.table.moved_to(directory + file.name());
}

PetscErrorCode SampleFiles::sync() {
  PetscFunctionBeginUser;
  for (File &file : files_) PetscCall(file.table.sync());
  PetscFunctionReturn(0);
}

bool SampleFiles::due(double time, bool series, bool last) const {
  for (const File &file : files_)
    if (file.direction < 0 ? series : profiles_due(time, last)) return true;
  return false;
}

PetscErrorCode SampleFiles::write(double time, bool series, bool last, const SampledFields &fields) {
  PetscFunctionBeginUser;
  const bool profiles = profiles_due(time, last);
  for (File &file : files_)
    if (file.direction < 0 ? series : profiles) PetscCall(write(file, time, fields));
  if (profiles) profile_due_.last_time = time;
  PetscFunctionReturn(0);
}

PetscErrorCode SampleFiles::write(File &file, double time, const SampledFields &fields) {
  PetscFunctionBeginUser;
  std::vector<Sample> samples;
  if (file.mean)
    PetscCall(sample_planes(*domain_, fields, file.direction, &samples));
  else
    PetscCall(sample_points(*domain_, fields, file.points, &samples));
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const Sample &s = samples[n];
    const Real3 &x = file.points[n];
    std::vector<double> line{time};
    if (file.direction < 0)
      line.insert(line.end(), {double(n + 1), x[0], x[1], x[2]});
    else
      line.push_back(x[file.direction]);
    line.insert(line.end(), {s.velocity[0], s.velocity[1], s.velocity[2], s.pressure, s.solid_fraction});
    PetscCall(file.table.write(line));
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
