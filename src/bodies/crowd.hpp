// Overlap queries between convex bodies in a domain, by bins of the largest diameter.
#pragma once

#include "bodies/convex.hpp"

#include <vector>

namespace eulastic {

class Crowd {
public:
  /// `diameter`: at least that of the largest body; `expected`: approximate number of bodies.
  Crowd(const DomainShape &grid, double diameter, std::size_t expected);

  std::size_t size() const { return bodies_.size(); }
  const PlacedConvex &operator[](std::size_t b) const { return bodies_[b]; }
  void add(const PlacedConvex &body);
  void move(std::size_t b, const PlacedConvex &to);
  static constexpr std::size_t nobody = static_cast<std::size_t>(-1);
  /// Returns the bodies that touch `body`, whose centre is in the domain, periodic images included.
  std::vector<int> touching(const PlacedConvex &body) const;
  /// Returns whether `body`, whose centre is in the domain, touches no body other than `except`, images included.
  bool has_room_for(const PlacedConvex &body, std::size_t except = nobody) const;
  /// Returns the penetrations of `body`, whose centre is in the domain, into bodies other than `except`, one for each
  /// periodic image.
  std::vector<Penetration> penetrations(const PlacedConvex &body, std::size_t except) const;

private:
  // The data that most queries need, two to a cache line: a million bodies are queried about ten times each.
  struct Link {
    Real3 centre;
    int next;  ///< next body in the chain of its bin, or -1
  };

  std::size_t bin(const Real3 &x) const;
  bool is_far(const Real3 &a, const Real3 &b, double reach) const;
  // Returns whether stop(shift) is true for an image of b that may touch a.
  template <class Stop>
  bool any_image(const PlacedConvex &a, const PlacedConvex &b, Stop stop) const;
  // Returns whether stop(index) is true for a body that touches `body`.
  template <class Stop>
  bool any_touching(const PlacedConvex &body, std::size_t except, Stop stop) const;

  DomainShape grid_;
  int dimension_;
  Int3 bins_{1, 1, 1};
  double widest_;  ///< upper bound of the outer radii
  std::vector<PlacedConvex> bodies_;
  std::vector<Link> links_;
  std::vector<int> first_;  ///< first body in the chain of every bin, or -1
};

}  // namespace eulastic
