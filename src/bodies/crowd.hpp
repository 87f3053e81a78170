// Convex bodies in a box, in bins of their largest diameter: who is in the way of whom.
#pragma once

#include "bodies/convex.hpp"

#include <vector>

namespace eulastic {

class Crowd {
public:
  /// `diameter`: at least that of the largest body; `expected`: about how many there will be.
  Crowd(const DomainShape &grid, double diameter, std::size_t expected);

  std::size_t size() const { return bodies_.size(); }
  const PlacedConvex &operator[](std::size_t b) const { return bodies_[b]; }
  void add(const PlacedConvex &body);
  void move(std::size_t b, const PlacedConvex &to);
  /// Those that touch body b, periodic images included.
  std::vector<int> touching(std::size_t b) const { return touching(bodies_[b], b); }
  /// Those that touch `body`, its centre in the box, but body `except`.
  std::vector<int> touching(const PlacedConvex &body, std::size_t except) const;
  /// Whether `body`, its centre in the box, touches none but body `except`, periodic images included.
  bool has_room_for(const PlacedConvex &body, std::size_t except) const;

  /// How deep `body`, its centre in the box, is in others but body `except`, in each periodic image.
  std::vector<Penetration> penetrations(const PlacedConvex &body, std::size_t except) const;

private:
  // What most looks need, two to a cache line: a million bodies are looked at some ten times each.
  struct Link {
    Real3 centre;
    int next;  ///< in the chain of its bin
  };

  std::size_t bin(const Real3 &x) const;
  bool is_far(const Real3 &a, const Real3 &b, double reach) const;
  // Whether `stop`(shift) says so of any image of b that may touch a.
  template <class Stop>
  bool any_image(const PlacedConvex &a, const PlacedConvex &b, Stop stop) const;
  bool clear(const PlacedConvex &a, const PlacedConvex &b) const;
  // Whether `stop`(index) says so of any body that touches this one.
  template <class Stop>
  bool any_touching(const PlacedConvex &body, std::size_t except, Stop stop) const;

  DomainShape grid_;
  int dimension_;
  Int3 bins_{1, 1, 1};
  double widest_;  ///< no outer radius is larger
  std::vector<PlacedConvex> bodies_;
  std::vector<Link> links_;
  std::vector<int> first_;  ///< of the chain of a bin
};

}  // namespace eulastic
