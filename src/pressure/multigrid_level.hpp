// One level of the V-cycle: its cells, which are equal except for the last one of a direction (wider or narrower if the
// number of cells was odd), their Laplacian as couplings along lines, and the transfer to the next level.
#pragma once

#include "kernels/poisson.hpp"
#include "pressure/agglomeration.hpp"
#include "pressure/partition.hpp"

namespace eulastic {

/// One value per cell of a direction and of `layers` cells around them; local indices from -layers on.
template <class T>
class LineOf {
public:
  static constexpr int layers = 4;

  void push_back(T value) { values_.push_back(value); }
  T operator[](int i) const { return values_[i + layers]; }
  const T *data() const { return values_.data() + layers; }

private:
  std::vector<T> values_;
};

/// Transfer between two levels along one direction, in local indices. The children of coarse cell I begin at first +
/// stride I. There are two of them, or one (stride 1, or a last cell without a partner), or three.
struct LineTransfer {
  int first = 0, stride = 1;
  /// [child][I]: share of the volume of I, 0 if there is no such child.
  std::array<std::vector<double>, 3> weight;
  LineOf<int> parent, neighbour;  ///< of fine cell i: its coarse cell, and the next one on the same side of the centre
  LineOf<double> share;           ///< weight of the neighbour in linear interpolation, 0 at walls
  std::vector<double> share_low, share_high;  ///< [I + 1]: share of the first and second child of I, -1 <= I < cells

  const double *low() const { return share_low.data() + 1; }
  const double *high() const { return share_high.data() + 1; }
};

class MultigridLevel {
public:
  using Widths = std::array<std::vector<double>, 3>;  ///< of all cells, in units of the finest spacing

  MultigridLevel(const Partition &partition, const Widths &widths, const Real3 &finest_spacing);
  MultigridLevel(const MultigridLevel &) = delete;

  const Partition &partition() const { return partition_; }
  /// The cells of this rank.
  const Box &box() const { return partition_.box(); }
  GhostExchange &exchange() { return exchange_; }
  bool single_cell() const { return box().domain_cell_count() == 1; }
  /// Whether this rank has cells.
  bool has_cells() const { return box().cell_count() > 0; }
  /// Sets the operator to lap - shift (1/length^2, not negative); it is lap at first.
  void set_shift(double shift);
  /// The step of an undamped relaxation, 1 / (sum over directions of -2/h^2, less the shift).
  double step() const { return step_; }
  /// Whether the operator has an inverse: the solution is 0 on some boundary, or there is a shift.
  bool is_regular() const { return shift_ > 0 || box().any_open(); }
  kernels::LineCoefficients coefficients(int j, int k) const {
    return {low_[0].data(), high_[0].data(), low_[1][j], high_[1][j], low_[2][k], high_[2][k], shift_};
  }

  /// The next level: coarser(); or the same cells on every rank if there are few of them; or the same cells on fewer
  /// ranks (Partition::joined()) if half of them would be too few for a rank.
  std::unique_ptr<MultigridLevel> next() const;
  /// The cells halved in the directions whose spacing is about the smallest.
  std::unique_ptr<MultigridLevel> coarser() const;
  /// The transfer to `coarse` along direction d.
  LineTransfer transfer(const MultigridLevel &coarse, int d) const;

  Field rhs, solution, scratch;                  ///< empty until allocated; the finest level uses its caller's fields
  int depth = 1;                                 ///< smoothing stages of a pass
  std::array<LineTransfer, 3> lines;             ///< to the next level, if it has fewer cells
  std::unique_ptr<Agglomeration> agglomeration;  ///< to the next level, if it has the same cells on other ranks

private:
  Partition partition_;
  GhostExchange exchange_;
  Widths widths_;
  Real3 finest_spacing_;
  std::array<LineOf<double>, 3> low_, high_;
  double diagonal_ = 0;  ///< of -lap in a cell inside
  double step_ = 0, shift_ = 0;
};

}  // namespace eulastic
