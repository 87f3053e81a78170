// Hashes by which the states of runs are compared.
#pragma once

#include "field/phase.hpp"

#include <cstdint>

namespace eulastic {

/// Hash of the owned points of one field, those on high boundaries included. The sum over fields and ranks (MPI_SUM of
/// uint64) does not depend on the ranks. `salt`: a different number for each field.
std::uint64_t hash_points(const Box &box, ConstView field, const Staggering &staggering, std::uint64_t salt);
/// Hash of one record.
std::uint64_t hash_values(const double *values, std::size_t count);

/// Hash of a body in a box of its own: of phi and B at points that contain a part of it, so that the rest of the box
/// does not matter, and of its markers.
std::uint64_t hash_body(const BodyInBox &body);

}  // namespace eulastic
