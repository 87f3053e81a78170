// Records of bonds for outputs: names of their ends, events, sums.
#pragma once

#include "grid/box.hpp"

#include <tuple>

namespace eulastic {

/// A receptor by the number of its body and its index there; body 0: a wall or a surface on the grid.
struct ReceptorName {
  int body = 0, index = 0;
  bool operator<(const ReceptorName &other) const { return std::tie(body, index) < std::tie(other.body, other.index); }
  bool operator==(const ReceptorName &other) const { return body == other.body && index == other.index; }
};

/// A bond that has formed or broken.
struct BondEvent {
  double time;
  bool formed;
  ReceptorName receptor, partner;
  int pair;             ///< index in AdhesionSpec::pairs
  double tension, age;  ///< when it broke; 0 for a new bond
};

/// The bonds of a body.
struct BodyBonds {
  int body = 0;
  int bonds = 0;
  Real3 force{};       ///< sum of the forces on the body
  double tension = 0;  ///< mean of its bonds
  double age = 0;      ///< mean of its bonds
};

/// Sums over all bonds.
struct BondTotals {
  double bonds = 0, formed = 0, broken = 0;  ///< at present; since the start
  Real3 force{};                             ///< sum of the forces on all bodies in boxes
};

/// Both ends of a bond and its tension.
struct BondLine {
  ReceptorName receptor, partner;
  Real3 from, to;
  double tension, since;
};

}  // namespace eulastic
