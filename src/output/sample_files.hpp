// probes.csv and profile_x.csv, _y, _z: the flow at points, along lines or averaged over planes.
#pragma once

#include "base/petsc.hpp"
#include "diagnostics/probes.hpp"
#include "grid/domain.hpp"
#include "io/series.hpp"
#include "output/due.hpp"
#include "scene/config.hpp"

namespace eulastic {

class SampleFiles {
public:
  /// Opens the files that `samples` requests. Of older rows in these files those of probes until `probes_time` and
  /// those of profiles until `profile_time` stay; negative: none.
  PetscErrorCode open(const SampleControl &samples, const Domain &domain, const std::string &directory,
                      double probes_time, double profile_time);
  void moved_to(const std::string &directory);
  /// Collective. All rows survive a power cut when this returns.
  PetscErrorCode sync();
  /// Time of the last profiles; negative if there are none yet.
  double profile_time() const { return profile_due_.last_time; }
  /// Whether write() would write something; `series`: series.csv gets a row now.
  bool due(double time, bool series, bool last) const;
  PetscErrorCode write(double time, bool series, bool last, const SampledFields &fields);

private:
  struct File {
    int direction;  ///< of a profile; -1: probes
    bool mean;
    std::vector<Real3> points;
    Series table;
    std::string name() const {
      return direction < 0 ? "/probes.csv" : std::string("/profile_") + "xyz"[direction] + ".csv";
    }
  };
  PetscErrorCode add(File &&file, const std::string &directory, double end);
  bool profiles_due(double time, bool last) const {
    return time != profile_due_.last_time && (last || profile_due_.at(time));
  }
  PetscErrorCode write(File &file, double time, const SampledFields &fields);

  const Domain *domain_ = nullptr;
  std::vector<File> files_;
  Due profile_due_;
};

}  // namespace eulastic
