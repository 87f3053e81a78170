// Valid ranges of the numbers in a checkpoint: a file with correct checksums may still contain numbers that no run has
// saved.
#pragma once

#include "bodies/measures.hpp"
#include "field/phase.hpp"
#include "io/checkpoint.hpp"

#include <string>
#include <vector>

namespace eulastic {

/// All of these return nothing, or an error about a number out of range, "time: -1; accepted: ...".
std::string find_invalid_number(const CheckpointNumbers &numbers);
std::string find_invalid_count(const std::string &name, const std::vector<long> &values);
std::string find_invalid_count(const std::string &name, const std::vector<double> &values);
/// `like`: of every body that has come in, the label of an earlier one; `placed`: bodies of the scene.
std::string find_invalid_link(const std::vector<long> &like, int placed);
/// Of one rank's share of the bodies: their cells, their first volumes, and their generators (0 = none) of
/// `generators`.
std::string find_invalid_body(const std::vector<long> &cells, const std::vector<double> &first_volumes);
std::string find_invalid_generator(const std::vector<long> &inside, int generators);
/// Markers of membranes in a block of cells, packed as by SurfaceMarker::packed().
std::string find_invalid_marker(const std::vector<double> &packed, const Extent &block, int bodies, int phases);
/// Receptors on bodies of a scene with so many pairs that adhere, packed as by Receptor::packed().
std::string find_invalid_receptor(const std::vector<double> &packed, int bodies, int pairs);
/// Heads of bodies in boxes (FreeBodies::packed) on the domain of a scene with these bodies and phases.
std::string find_invalid_box(const std::vector<double> &heads, const Box &domain, const BodyTracker &bodies,
                             const std::vector<Phase> &phases);

}  // namespace eulastic
