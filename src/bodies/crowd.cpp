#include "bodies/crowd.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

Crowd::Crowd(const DomainShape &grid, double diameter, std::size_t expected)
    : grid_(grid), dimension_(grid.dimension()), widest_(diameter / 2) {
  const double most = std::max(8.0, std::pow(double(expected), 1.0 / dimension_) * 2);
  double count = 1;
  for (int d = 0; d < dimension_; ++d) {
    bins_[d] = static_cast<int>(std::clamp(std::floor(grid.length[d] / diameter), 1.0, 1e6));
    count *= bins_[d];
  }
  if (count > std::pow(most, dimension_))  // few bodies in a wide box
    for (int d = 0; d < dimension_; ++d)
      bins_[d] = std::max(1, static_cast<int>(bins_[d] * most / std::pow(count, 1.0 / dimension_)));
  first_.assign(std::size_t(bins_[0]) * bins_[1] * bins_[2], -1);
  bodies_.reserve(expected);
  links_.reserve(expected);
}

std::size_t Crowd::bin(const Real3 &x) const {
  Int3 i{};
  for (int d = 0; d < dimension_; ++d)
    i[d] = std::clamp(static_cast<int>(x[d] / grid_.length[d] * bins_[d]), 0, bins_[d] - 1);
  return i[0] + std::size_t(bins_[0]) * (i[1] + std::size_t(bins_[1]) * i[2]);
}

void Crowd::add(const PlacedConvex &body) {
  int &first = first_[bin(body.centre)];
  links_.push_back({body.centre, first});
  first = static_cast<int>(bodies_.size());
  bodies_.push_back(body);
}

void Crowd::move(std::size_t b, const PlacedConvex &to) {
  const int index = static_cast<int>(b);
  int *link = &first_[bin(bodies_[b].centre)];
  while (*link != index) link = &links_[*link].next;
  *link = links_[b].next;
  int &first = first_[bin(to.centre)];
  links_[b] = {to.centre, first};
  first = index;
  bodies_[b] = to;
}

// Returns whether all periodic images of b are farther from a than `reach`.
bool Crowd::is_far(const Real3 &a, const Real3 &b, double reach) const {
  double square = 0;
  for (int d = 0; d < dimension_; ++d) {
    double x = std::abs(b[d] - a[d]);
    if (grid_.boundary[d] == Boundary::periodic) x = std::min(x, grid_.length[d] - x);
    square += x * x;
  }
  return square > reach * reach;
}

template <class Stop>
bool Crowd::any_image(const PlacedConvex &a, const PlacedConvex &b, Stop stop) const {
  const double reach = a.body->outer_radius() + b.body->outer_radius();
  Int3 from{}, to{};
  for (int d = 0; d < dimension_; ++d) {
    const double x = b.centre[d] - a.centre[d], length = grid_.length[d];
    if (grid_.boundary[d] == Boundary::wall || std::abs(x) <= length - reach)
      continue;  // only the body itself may be near
    from[d] = static_cast<int>(std::ceil((-reach - x) / length));
    to[d] = static_cast<int>(std::floor((reach - x) / length));
  }
  for (int k = from[2]; k <= to[2]; ++k)
    for (int j = from[1]; j <= to[1]; ++j)
      for (int i = from[0]; i <= to[0]; ++i)
        if (stop(Real3{i * grid_.length[0], j * grid_.length[1], k * grid_.length[2]})) return true;
  return false;
}

template <class Stop>
bool Crowd::any_touching(const PlacedConvex &body, std::size_t except, Stop stop) const {
  Int3 list[3], count{1, 1, 1};  // neighbouring bins along each direction, without duplicates
  for (int d = 0; d < 3; ++d) {
    list[d] = {0, 1, 2};
    if (d >= dimension_ || bins_[d] <= 3) {
      count[d] = bins_[d];
      continue;
    }
    const int middle = std::clamp(static_cast<int>(body.centre[d] / grid_.length[d] * bins_[d]), 0, bins_[d] - 1);
    count[d] = 0;
    for (int i : {middle, middle - 1, middle + 1}) {  // the nearest bin first: overlaps are found early
      const int wrapped = (i + bins_[d]) % bins_[d];
      if (wrapped == i || grid_.boundary[d] == Boundary::periodic) list[d][count[d]++] = wrapped;
    }
  }
  const double reach = 1.0001 * (body.body->outer_radius() + widest_);  // allows for the round-off of images
  for (int k = 0; k < count[2]; ++k)
    for (int j = 0; j < count[1]; ++j)
      for (int i = 0; i < count[0]; ++i) {
        const std::size_t at = list[0][i] + std::size_t(bins_[0]) * (list[1][j] + std::size_t(bins_[1]) * list[2][k]);
        for (int b = first_[at]; b >= 0; b = links_[b].next) {
          if (static_cast<std::size_t>(b) == except || is_far(body.centre, links_[b].centre, reach)) continue;
          const auto touches = [&](const Real3 &shift) { return !separated(body, bodies_[b], shift); };
          if (any_image(body, bodies_[b], touches) && stop(b)) return true;
        }
      }
  return false;
}

bool Crowd::has_room_for(const PlacedConvex &body, std::size_t except) const {
  return !any_touching(body, except, [](int) { return true; });
}

std::vector<int> Crowd::touching(const PlacedConvex &body) const {
  std::vector<int> found;
  any_touching(body, nobody, [&](int other) {
    found.push_back(other);
    return false;
  });
  return found;
}

std::vector<Penetration> Crowd::penetrations(const PlacedConvex &body, std::size_t except) const {
  std::vector<Penetration> found;
  any_touching(body, except, [&](int other) {
    (void)any_image(body, bodies_[other], [&](const Real3 &shift) {
      Penetration with = penetration(body, bodies_[other], shift);
      with.other = other;
      if (with.depth > 0) found.push_back(with);
      return false;
    });
    return false;
  });
  return found;
}

}  // namespace eulastic
