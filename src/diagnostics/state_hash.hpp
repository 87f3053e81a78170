// A hash of the state, by which runs are compared.
#pragma once

#include "field/phase.hpp"

#include <cstdint>

namespace eulastic {

/// Rank-independent hash of the owned points of one field, those on high sides included, to be added up over fields and
/// ranks (MPI_SUM on uint64). `salt` tells fields apart.
std::uint64_t hash_points(const Box &box, ConstView field, const Staggering &staggering, std::uint64_t salt);
/// Hash of one record.
std::uint64_t hash_values(const double *values, std::size_t count);

/// The same of a body in a box of its own: of phi and B where it has a part, so that the hash does not depend on what
/// else the box holds.
std::uint64_t hash_body(const BodyInBox &body);

}  // namespace eulastic
