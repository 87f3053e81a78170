#include "diagnostics/state_hash.hpp"

#include <array>
#include <cstring>

namespace eulastic {
namespace {

std::uint64_t bits_of(double value) noexcept {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

// The finaliser of SplitMix64 (Steele, Lea, Flood 2014).
std::uint64_t mix(std::uint64_t x) noexcept {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

}  // namespace

std::uint64_t hash_points(const Box &box, ConstView field, const Staggering &staggering, std::uint64_t salt) {
  const Layout &own = box.layout();
  std::uint64_t hash = 0;
  for (int k = 0; k < box.points_end(2, staggering[2]); ++k)
    for (int j = 0; j < box.points_end(1, staggering[1]); ++j) {
      const double *row = field.row(j, k);
      const std::uint64_t y = own.begin[1] + j, z = own.begin[2] + k;
      const std::uint64_t row_key = mix(salt ^ mix(y + (z << 32)));
      for (int i = 0; i < box.points_end(0, staggering[0]); ++i)
        hash += mix(bits_of(row[i]) ^ mix(row_key + own.begin[0] + i));
    }
  return hash;
}

std::uint64_t hash_body(const BodyInBox &body) {
  const Box &box = *body.box;
  const Int3 &begin = box.layout().begin;
  const ConstView phi = body.phase->fraction[0];
  std::uint64_t hash = 0;
  // `near`: offsets to the centres around a point.
  const auto add = [&](ConstView field, const Staggering &at, const std::array<std::ptrdiff_t, 2> &near,
                       int component) {
    for (int k = 0; k < box.points_end(2, at[2]); ++k)
      for (int j = 0; j < box.points_end(1, at[1]); ++j) {
        const std::uint64_t y = static_cast<std::uint32_t>(begin[1] + j), z = static_cast<std::uint32_t>(begin[2] + k);
        const std::uint64_t row_key = mix(mix(body.number + (std::uint64_t(component) << 32)) ^ mix(y + (z << 32)));
        for (int i = 0; i < box.points_end(0, at[0]); ++i) {
          const double *q = &phi(i, j, k);
          if (q[0] != 0 || q[-near[0]] != 0 || q[-near[1]] != 0 || q[-near[0] - near[1]] != 0)
            hash += mix(bits_of(field(i, j, k)) ^ mix(row_key + static_cast<std::uint32_t>(begin[0] + i)));
        }
      }
  };
  add(phi, at_centre, {0, 0}, 0);
  for (int c = 0; c < body.phase->tensor.field.count(); ++c) {
    const TensorComponent &component = body.phase->tensor.components()[c];
    add(body.phase->tensor.field[c], component.at, component.steps(phi), 1 + c);
  }
  for (const SurfaceMarker &marker : *body.markers) {
    const auto values = marker.packed();
    hash += hash_values(values.data(), values.size());
  }
  return hash;
}

std::uint64_t hash_values(const double *values, std::size_t count) {
  std::uint64_t hash = 0;
  for (std::size_t n = 0; n < count; ++n) hash = mix(hash ^ mix(bits_of(values[n])));
  return hash;
}

}  // namespace eulastic
