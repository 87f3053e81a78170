#include "bodies/resample.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace eulastic {
namespace {

constexpr int most_voxels = 1 << 18;  // in one piece

struct Overlap {
  int cell;       // of the window
  double weight;  // part of the cell
};

// What the voxels of one direction share with the cells of the window.
struct Overlaps {
  int begin = 0, end = 0;             // voxels
  std::vector<std::size_t> start{0};  // of voxel begin + n in `list`
  std::vector<Overlap> list;
};

// Begin of voxel i in cells from the low side of the box; on a cell face exactly if it is there up to round-off.
double edge(const VoxelBox &box, double h, int d, int i) {
  const double x = box.corner[d] + double(i) * box.spacing[d], e = x / h, face = std::round(e);
  const double size = (std::abs(box.corner[d]) + double(i) * box.spacing[d]) / h + 1;
  return std::abs(e - face) <= 8 * std::numeric_limits<double>::epsilon() * size ? face : e;
}

Overlaps find_overlaps(const CellWindow &window, const VoxelBox &box, int d) {
  const double h = window.spacing(d);
  const int first = window.begin[d], last = first + window.size[d];
  // The voxel around a place, a little too low, within the volume.
  const auto voxel_at = [&](int cell) {
    const double i = std::floor((cell * h - box.corner[d]) / box.spacing[d]) - 1;
    return static_cast<int>(std::clamp(i, 0.0, double(box.count[d])));
  };
  Overlaps result;
  result.begin = voxel_at(first);
  while (result.begin < box.count[d] && edge(box, h, d, result.begin + 1) <= first) ++result.begin;
  result.end = result.begin;
  for (; result.end < box.count[d]; ++result.end) {
    const double low = edge(box, h, d, result.end), high = edge(box, h, d, result.end + 1);
    if (low >= last) break;
    const int from = static_cast<int>(std::max(std::floor(low), double(first)));
    for (int c = from; c < last && c < high; ++c) {
      const double weight = std::min(high, c + 1.0) - std::max(low, double(c));
      if (weight > 0) result.list.push_back({c - first, weight});
    }
    result.start.push_back(result.list.size());
  }
  return result;
}

template <class Visit>
void for_overlaps(const Overlaps &overlaps, int voxel, Visit visit) {
  const std::size_t n = static_cast<std::size_t>(voxel - overlaps.begin);
  for (std::size_t o = overlaps.start[n]; o < overlaps.start[n + 1]; ++o) visit(overlaps.list[o]);
}

}  // namespace

double clean_fraction(double phi) noexcept { return phi < 1e-12 ? 0 : phi > 1 - 1e-12 ? 1 : phi; }

std::string resample(const CellWindow &window, const VoxelBox &box, const ReadVoxels &read, View fraction) {
  const Int3 &size = window.size;
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j) std::fill_n(fraction.row(j, k), size[0], 0.0);
  const Overlaps x = find_overlaps(window, box, 0), y = find_overlaps(window, box, 1),
                 z = find_overlaps(window, box, 2);
  const int nx = x.end - x.begin, ny = y.end - y.begin;
  if (nx < 1 || ny < 1 || z.end == z.begin) return {};
  const int step_x = std::min(nx, most_voxels), step_y = std::min(ny, most_voxels / step_x);
  const int step_z = std::min(z.end - z.begin, most_voxels / step_x / step_y);
  std::vector<double> voxels(std::size_t(step_x) * step_y * step_z), row(size[0]);
  for (int k0 = z.begin; k0 < z.end; k0 += step_z)
    for (int j0 = y.begin; j0 < y.end; j0 += step_y)
      for (int i0 = x.begin; i0 < x.end; i0 += step_x) {
        const Int3 end{std::min(i0 + step_x, x.end), std::min(j0 + step_y, y.end), std::min(k0 + step_z, z.end)};
        if (std::string wrong = read({i0, j0, k0}, end, voxels.data()); !wrong.empty()) return wrong;
        const double *voxel = voxels.data();
        for (int k = k0; k < end[2]; ++k)
          for (int j = j0; j < end[1]; ++j) {
            if (i0 == x.begin) std::fill(row.begin(), row.end(), 0.0);
            for (int i = i0; i < end[0]; ++i, ++voxel)
              if (*voxel != 0) for_overlaps(x, i, [&](const Overlap &o) { row[o.cell] += o.weight * *voxel; });
            if (end[0] < x.end) continue;  // the rest of a very long row follows
            for_overlaps(z, k, [&](const Overlap &oz) {
              for_overlaps(y, j, [&](const Overlap &oy) {
                double *phi = &fraction(0, oy.cell, oz.cell);
                for (std::size_t c = 0; c < row.size(); ++c) phi[c] += oz.weight * oy.weight * row[c];
              });
            });
          }
      }
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i) fraction(i, j, k) = clean_fraction(fraction(i, j, k));
  return {};
}

}  // namespace eulastic
