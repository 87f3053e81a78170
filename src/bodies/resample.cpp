#include "bodies/resample.hpp"

#include "base/rank_zero.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace eulastic {
namespace {

constexpr int most_voxels = 1 << 18;  // read in one piece

struct Overlap {
  int cell;       // index in the window
  double weight;  // fraction of the cell
};

// Overlaps of voxels with the cells of the window along one direction.
struct Overlaps {
  int begin = 0, end = 0;             // range of voxels
  std::vector<std::size_t> start{0};  // start[n]: first entry of voxel begin + n in `list`
  std::vector<Overlap> list;
};

// Returns the low edge of voxel i, in cells from the low boundary; it is exactly on a cell face if it is there up to
// round-off.
double edge(const VoxelBox &box, double h, int d, int i) {
  const double x = box.corner[d] + double(i) * box.spacing[d], e = x / h, face = std::round(e);
  const double size = (std::abs(box.corner[d]) + double(i) * box.spacing[d]) / h + 1;
  return std::abs(e - face) <= 8 * std::numeric_limits<double>::epsilon() * size ? face : e;
}

Overlaps find_overlaps(const CellWindow &window, const VoxelBox &box, int d) {
  const double h = window.spacing(d);
  const int first = window.begin[d], last = first + window.size[d];
  // Returns the voxel that contains a cell face, or one before it, within the volume.
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

// Returns the box of voxels [first, last) that overlap cells of any rank.
std::pair<Int3, Int3> voxels_of_all(const Overlaps &x, const Overlaps &y, const Overlaps &z) {
  std::array<int, 6> bounds{x.begin, y.begin, z.begin, -x.end, -y.end, -z.end};
  if (x.begin == x.end || y.begin == y.end || z.begin == z.end) bounds.fill(std::numeric_limits<int>::max());
  (void)MPI_Allreduce(MPI_IN_PLACE, bounds.data(), 6, MPI_INT, MPI_MIN, run_communicator());
  return {{bounds[0], bounds[1], bounds[2]}, {-bounds[3], -bounds[4], -bounds[5]}};
}

}  // namespace

double clean_fraction(double phi) noexcept { return phi < 1e-12 ? 0 : phi > 1 - 1e-12 ? 1 : phi; }

std::string resample(const CellWindow &window, const VoxelBox &box, const ReadVoxels &read, View fraction) {
  const Int3 &size = window.size;
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j) std::fill_n(fraction.row(j, k), size[0], 0.0);
  const Overlaps x = find_overlaps(window, box, 0), y = find_overlaps(window, box, 1),
                 z = find_overlaps(window, box, 2);
  const auto [first, last] = voxels_of_all(x, y, z);
  Int3 step;
  int most = most_voxels;
  for (int d = 0; d < 3; ++d) {
    if (last[d] <= first[d]) return {};
    step[d] = std::min(last[d] - first[d], most);
    most /= step[d];
  }
  std::vector<double> voxels(std::size_t(step[0]) * step[1] * step[2]), row(size[0]);
  for (int k0 = first[2]; k0 < last[2]; k0 += step[2])
    for (int j0 = first[1]; j0 < last[1]; j0 += step[1])
      for (int i0 = first[0]; i0 < last[0]; i0 += step[0]) {
        const Int3 end{std::min(i0 + step[0], last[0]), std::min(j0 + step[1], last[1]),
                       std::min(k0 + step[2], last[2])};
        if (std::string wrong = read({i0, j0, k0}, end, voxels.data()); !wrong.empty()) return wrong;
        for (int k = std::max(k0, z.begin); k < std::min(end[2], z.end); ++k)
          for (int j = std::max(j0, y.begin); j < std::min(end[1], y.end); ++j) {
            const double *voxel = &voxels[(std::size_t(k - k0) * (end[1] - j0) + (j - j0)) * (end[0] - i0)];
            if (i0 == first[0]) std::fill(row.begin(), row.end(), 0.0);
            for (int i = std::max(i0, x.begin); i < std::min(end[0], x.end); ++i)
              if (const double q = voxel[i - i0]; q != 0)
                for_overlaps(x, i, [&](const Overlap &o) { row[o.cell] += o.weight * q; });
            if (end[0] < last[0]) continue;  // the rest of a very long row follows
            for_overlaps(z, k, [&](const Overlap &oz) {
              for_overlaps(y, j, [&](const Overlap &oy) {
                double *phi = &fraction(0, oy.cell, oz.cell);
                for (std::size_t c = 0; c < row.size(); ++c) phi[c] += oz.weight * oy.weight * row[c];
              });
            });
          }
      }
  for_points({{0, 0, 0}, size}, [&](int i, int j, int k) { fraction(i, j, k) = clean_fraction(fraction(i, j, k)); });
  return {};
}

}  // namespace eulastic
