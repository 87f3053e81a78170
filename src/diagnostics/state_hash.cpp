#include "diagnostics/state_hash.hpp"

namespace eulastic {

std::uint64_t hash_points(const Box &box, ConstView field, const Staggering &staggering, std::uint64_t salt) {
  const Layout &own = box.layout();
  std::uint64_t hash = 0;
  for (int k = 0; k < box.points_end(2, staggering[2]); ++k)
    for (int j = 0; j < box.points_end(1, staggering[1]); ++j) {
      const double *row = field.row(j, k);
      const std::uint64_t y = own.begin[1] + j, z = own.begin[2] + k;
      const std::uint64_t row_key = mix_bits(salt ^ mix_bits(y + (z << 32)));
      for (int i = 0; i < box.points_end(0, staggering[0]); ++i)
        hash += mix_bits(bits_of(row[i]) ^ mix_bits(row_key + own.begin[0] + i));
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
        const std::uint64_t row_key =
            mix_bits(mix_bits(body.number + (std::uint64_t(component) << 32)) ^ mix_bits(y + (z << 32)));
        for (int i = 0; i < box.points_end(0, at[0]); ++i) {
          const double *q = &phi(i, j, k);
          if (q[0] != 0 || q[-near[0]] != 0 || q[-near[1]] != 0 || q[-near[0] - near[1]] != 0)
            hash += mix_bits(bits_of(field(i, j, k)) ^ mix_bits(row_key + static_cast<std::uint32_t>(begin[0] + i)));
        }
      }
  };
  add(phi, at_centre, {0, 0}, 0);
  for (int c = 0; c < body.phase->tensor.field.count(); ++c) {
    const TensorComponent &component = body.phase->tensor.components()[c];
    add(body.phase->tensor.field[c], component.at, component.steps(phi), 1 + c);
  }
  for (const SurfaceMarker &marker : *body.markers) hash += hash_values(marker.packed());
  return hash;
}

}  // namespace eulastic
