// Valid ranges of the numbers in a checkpoint: a file with correct checksums may still contain numbers that no run has
// saved.
#pragma once

#include "bodies/measures.hpp"
#include "field/phase.hpp"
#include "io/checkpoint.hpp"

#include <string>
#include <vector>

namespace eulastic {

/// The values that a number may have.
struct Accepted {
  double low, high;
  std::string words;
  bool whole = false;  ///< whether it must be a whole number
};

/// Counts of steps, rows and the like, which doubles still hold exactly.
extern const Accepted any_count;

/// All of these return nothing, or an error about a number out of range, "time holds -1; accepted: ...".
/// `values`: records of accepted.size() numbers each.
std::string find_invalid(const std::string &name, const std::vector<double> &values,
                         const std::vector<Accepted> &accepted);
std::string find_invalid(const std::string &name, const std::vector<long> &values, const Accepted &accepted);
std::string find_invalid_number(const CheckpointNumbers &numbers);
/// `like`: of every body that has come in, the label of an earlier one; `placed`: bodies of the scene.
std::string find_invalid_link(const std::vector<long> &like, int placed);
/// Markers of membranes in a block of cells, packed as by SurfaceMarker::packed().
std::string find_invalid_marker(const std::vector<double> &packed, const Extent &block, int bodies, int phases);
/// Receptors on bodies of a scene with so many pairs that adhere, packed as by Receptor::packed().
std::string find_invalid_receptor(const std::vector<double> &packed, int bodies, int pairs);
/// Heads of bodies in boxes (FreeBodies::packed) on the domain of a scene with these bodies and phases.
std::string find_invalid_box(const std::vector<double> &heads, const Box &domain, const BodyTracker &bodies,
                             const std::vector<Phase> &phases);

}  // namespace eulastic
