#include "bodies/near_bodies.hpp"

#include <algorithm>
#include <limits>

namespace eulastic {
namespace {

constexpr double nobody = std::numeric_limits<double>::infinity();

// The owned cells and `reach` layers of those around them.
struct CellRange {
  Int3 begin{}, end{};
  CellRange(const Box &box, int reach) {
    for (int d = 0; d < 3; ++d) {
      const Box::Range near = box.points_near(d, false, reach);
      begin[d] = near.begin;
      end[d] = near.end;
    }
  }
  CellRange around(const Int3 &cell, int reach) const {
    CellRange range = *this;
    for (int d = 0; d < 3; ++d) {
      range.begin[d] = std::max(begin[d], cell[d] - reach);
      range.end[d] = std::min(end[d], cell[d] + reach + 1);
    }
    return range;
  }
};

// Smallest and largest label in blocks of `size` cells each way; the blocks begin with the box.
struct Blocks {
  int size;
  CellRange range;
  Int3 count{};
  std::vector<double> low, high;

  Blocks(const CellRange &cells, const BodyCells &bodies, int block_size) : size(block_size), range(cells) {
    for (int d = 0; d < 3; ++d) count[d] = (range.end[d] - range.begin[d] + size - 1) / size;
    low.assign(std::size_t(count[0]) * count[1] * count[2], nobody);
    high.assign(low.size(), 0);
    const int width = range.end[0] - range.begin[0];
    std::vector<double> row_low(width), row_high(width);
    for (int bk = 0; bk < count[2]; ++bk)
      for (int bj = 0; bj < count[1]; ++bj) {
        std::fill(row_low.begin(), row_low.end(), nobody);
        std::fill(row_high.begin(), row_high.end(), 0);
        for (int k = first(2, bk); k < last(2, bk); ++k)
          for (int j = first(1, bj); j < last(1, bj); ++j) {
            const double *q = bodies.label.row(j, k) + range.begin[0],
                         *phi = bodies.fraction.row(j, k) + range.begin[0];
            double *const least = row_low.data(), *const most = row_high.data();
#pragma omp simd
            for (int i = 0; i < width; ++i) {
              const double own = phi[i] > BodyCells::threshold ? q[i] : 0, low_one = own > 0 ? own : nobody;
              least[i] = low_one < least[i] ? low_one : least[i];
              most[i] = own > most[i] ? own : most[i];
            }
          }
        const std::size_t row = std::size_t(count[0]) * (bj + std::size_t(count[1]) * bk);
        for (int i = 0; i < width; ++i) {
          low[row + i / size] = std::min(low[row + i / size], row_low[i]);
          high[row + i / size] = std::max(high[row + i / size], row_high[i]);
        }
      }
  }
  int first(int d, int block) const { return range.begin[d] + block * size; }
  int last(int d, int block) const { return std::min(first(d, block) + size, range.end[d]); }
  // Whether a block and those around it hold labels of more than one body.
  bool is_mixed(int bi, int bj, int bk) const {
    double least = nobody, most = 0;
    for (int k = std::max(bk - 1, 0); k < std::min(bk + 2, count[2]); ++k)
      for (int j = std::max(bj - 1, 0); j < std::min(bj + 2, count[1]); ++j)
        for (int i = std::max(bi - 1, 0); i < std::min(bi + 2, count[0]); ++i) {
          const std::size_t b = i + std::size_t(count[0]) * (j + std::size_t(count[1]) * k);
          least = std::min(least, low[b]);
          most = std::max(most, high[b]);
        }
    return least < most;
  }
};

// On the skin of its body, where the cell of it that is nearest to anything is.
bool is_skin(const Box &box, const BodyCells &cells, const Int3 &c) {
  const double own = cells(c[0], c[1], c[2]);
  for (int d = 0; d < box.dimension(); ++d)
    for (const int side : {-1, 1}) {
      Int3 next = c;
      next[d] += side;
      if (cells(next[0], next[1], next[2]) != own) return true;
    }
  return false;
}

// Adds the pairs of body `own` of a cell with the other labels in a box around it.
void look_around(const BodyCells &cells, const CellRange &window, double own, int phase,
                 std::vector<NearBodies> *found) {
  for (int k = window.begin[2]; k < window.end[2]; ++k)
    for (int j = window.begin[1]; j < window.end[1]; ++j)
      for (int i = window.begin[0]; i < window.end[0]; ++i) {
        const double label = cells.label(i, j, k);
        if (label <= 0 || label == own || cells(i, j, k) <= 0) continue;
        const NearBodies pair{static_cast<int>(own), static_cast<int>(label), phase};
        if (found->empty() || !(found->back() == pair)) found->push_back(pair);
      }
}

void sort_out(std::vector<NearBodies> *found) {
  std::sort(found->begin(), found->end());
  found->erase(std::unique(found->begin(), found->end()), found->end());
}

}  // namespace

std::vector<int> labels_in(const Box &box, ConstView label, int reach) {
  const CellRange range(box, reach);
  std::vector<int> labels;
  double last = 0;
  std::size_t sorted = 64;
  const auto sort = [&] {
    std::sort(labels.begin(), labels.end());
    labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  };
  for (int k = range.begin[2]; k < range.end[2]; ++k)
    for (int j = range.begin[1]; j < range.end[1]; ++j) {
      const double *names = label.row(j, k);
      for (int i = range.begin[0]; i < range.end[0]; ++i) {
        if (names[i] > 0 && names[i] != last) labels.push_back(static_cast<int>(names[i]));
        last = names[i];
      }
      if (labels.size() > 2 * sorted) {
        sort();
        sorted = std::max(labels.size(), sorted);
      }
    }
  sort();
  return labels;
}

void find_near_in_phase(const Box &box, const BodyCells &cells, int phase, int reach, std::vector<NearBodies> *found) {
  const CellRange all(box, reach), owned(box, 0);
  const Blocks blocks(all, cells, reach);
  std::vector<NearBodies> pairs;
  for (int bk = 0; bk < blocks.count[2]; ++bk)
    for (int bj = 0; bj < blocks.count[1]; ++bj)
      for (int bi = 0; bi < blocks.count[0]; ++bi) {
        if (!blocks.is_mixed(bi, bj, bk)) continue;
        for (int k = std::max(blocks.first(2, bk), 0); k < std::min(blocks.last(2, bk), owned.end[2]); ++k)
          for (int j = std::max(blocks.first(1, bj), 0); j < std::min(blocks.last(1, bj), owned.end[1]); ++j)
            for (int i = std::max(blocks.first(0, bi), 0); i < std::min(blocks.last(0, bi), owned.end[0]); ++i)
              if (cells(i, j, k) > 0 && is_skin(box, cells, {i, j, k}))
                look_around(cells, all.around({i, j, k}, reach), cells(i, j, k), phase, &pairs);
        sort_out(&pairs);
      }
  for (NearBodies &pair : pairs)
    if (pair.body < pair.other) std::swap(pair.body, pair.other);
  sort_out(&pairs);
  found->insert(found->end(), pairs.begin(), pairs.end());
}

void find_near_others(const Box &box, const BodyCells &own, const std::vector<int> &labels, const BodyCells &others,
                      int phase, int reach, std::vector<NearBodies> *found) {
  const CellRange all(box, reach);
  std::vector<NearBodies> pairs;
  for (const Segment &row : box.rows()) {
    for (int i = row.i_begin; i < row.i_end; ++i) {
      const double label = own(i, row.j, row.k);
      if (label <= 0 || !std::binary_search(labels.begin(), labels.end(), static_cast<int>(label))) continue;
      if (is_skin(box, own, {i, row.j, row.k}))
        look_around(others, all.around({i, row.j, row.k}, reach), label, phase, &pairs);
    }
    sort_out(&pairs);
  }
  found->insert(found->end(), pairs.begin(), pairs.end());
}

}  // namespace eulastic
