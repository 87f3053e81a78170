// Convex bodies in a box, in bins of their largest diameter: who is in the way of whom.
#pragma once

#include "bodies/convex.hpp"

#include <vector>

namespace eulastic {

class Crowd {
public:
  /// `diameter`: at least that of the largest body; `expected`: about how many there will be.
  Crowd(const GridSpec &grid, double diameter, std::size_t expected);

  std::size_t size() const { return bodies_.size(); }
  const PlacedConvex &operator[](std::size_t b) const { return bodies_[b]; }
  void add(const PlacedConvex &body);
  void move(std::size_t b, const PlacedConvex &to);
  /// Whether `body`, its centre in the box, touches none but body `except`, periodic images included.
  bool has_room_for(const PlacedConvex &body, std::size_t except) const;

private:
  std::size_t bin(const Real3 &x) const;
  bool clear(const PlacedConvex &a, const PlacedConvex &b) const;

  GridSpec grid_;
  int dimension_;
  Int3 bins_{1, 1, 1};
  std::vector<PlacedConvex> bodies_;
  std::vector<int> first_, next_;  ///< of a bin, of a body: chains
};

}  // namespace eulastic
