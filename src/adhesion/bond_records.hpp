// What is known of bonds beside their forces: names of their ends, events, sums.
#pragma once

#include "grid/box.hpp"

#include <tuple>

namespace eulastic {

/// A receptor of all: number of the body and index among those of the body; body 0: a wall or a surface on the grid.
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
  int pair;             ///< of AdhesionSpec::pairs
  double tension, age;  ///< of a bond that breaks
};

/// What the bonds of a body do.
struct BodyBonds {
  int body = 0;
  int bonds = 0;
  Real3 force{};       ///< on the body
  double tension = 0;  ///< mean of its bonds
  double age = 0;      ///< mean of its bonds
};

/// Of all bonds.
struct BondTotals {
  double bonds = 0, formed = 0, broken = 0;  ///< now; since the start
  Real3 force{};                             ///< on the bodies in boxes, all together
};

/// Both ends of a bond and its tension.
struct BondLine {
  ReceptorName receptor, partner;
  Real3 from, to;
  double tension, since;
};

}  // namespace eulastic
