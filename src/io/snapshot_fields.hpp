// Which datasets a snapshot holds, from the state: names as -initial_state reads them, each at its own place.
#pragma once

#include "field/phase.hpp"
#include "io/snapshot.hpp"

namespace eulastic {

/// Views of the state, and the fields that are made for the file: the velocity at centres and, with several species,
/// what they have in common.
class SnapshotFields {
public:
  explicit SnapshotFields(const Box &box) : box_(&box) {}

  /// Collects the groups of datasets that `wanted` names (-snapshot_fields); bodies without labels have no dataset. One
  /// ghost layer must be valid in `velocity` and, with several species, in their fractions. The result holds views: it
  /// is good until the state or this object changes.
  std::vector<SnapshotField> collect(const std::vector<std::string> &wanted, Stored precision, const Field &velocity,
                                     const Field &pressure, const std::vector<Phase> &phases);

private:
  void centre_velocity(const Field &velocity);
  void mix_fractions(const std::vector<Phase> &phases);
  void mix_labels(const std::vector<Phase> &phases);
  void mix_tensors(const std::vector<Phase> &phases);

  const Box *box_;
  Field velocity_, fraction_, label_;
  CarriedTensor tensor_;
};

}  // namespace eulastic
