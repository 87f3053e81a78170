// probes.csv and profile_x.csv, _y, _z: the flow at points, along lines or averaged over planes.
#pragma once

#include "app/config.hpp"
#include "app/due.hpp"
#include "diagnostics/probes.hpp"
#include "io/series.hpp"

namespace eulastic {

class SampleFiles {
public:
  /// Opens what `samples` asks for. A run that goes on at time `begin` > 0 keeps the rows until then.
  PetscErrorCode open(const SampleControl &samples, const Grid &grid, const std::string &directory, double begin);
  /// Whether write() would write something; `series`: series.csv gets a row now.
  bool due(double time, bool series, bool last) const;
  PetscErrorCode write(double time, bool series, bool last, const SampledFields &fields);

private:
  struct File {
    int direction;  ///< of a profile; -1: probes
    bool mean;
    std::vector<Real3> points;
    Series table;
  };
  PetscErrorCode add(int direction, bool mean, std::vector<Real3> points, const std::string &path, double begin);
  bool profiles_due(double time, bool last) const {
    return time != profile_due_.last_time && (last || profile_due_.at(time));
  }
  PetscErrorCode write(File &file, double time, const SampledFields &fields);

  const Grid *grid_ = nullptr;
  std::vector<File> files_;
  Due profile_due_;
};

}  // namespace eulastic
