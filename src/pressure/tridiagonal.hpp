// Solves eight lines at a time of  (2 + shift) q_j - q_{j-1} - q_{j+1} = g_j,  periodic or between boundaries: closed
// (q_{-1} = q_0) or open (q_{-1} = -q_0).
#pragma once

#include <array>
#include <vector>

namespace eulastic {

class TridiagonalLines {
public:
  static constexpr int lanes = 8;
  static constexpr int flops_per_value = 12;

  TridiagonalLines() = default;
  /// `cells` >= 3 per line.
  TridiagonalLines(int cells, bool periodic, std::array<bool, 2> open = {})
      : cells_(cells), periodic_(periodic), open_(open), work_(3 * lanes * cells) {}
  /// The eight values of one j: g before solve(), q after it.
  double *row(int j) { return work_.data() + lanes * j; }
  /// Solves all lanes. `shift` >= 0, one per lane. A lane with shift 0 and no open boundary is singular: the means of
  /// its g and q are removed.
  void solve(const double *shift);

private:
  void remove_mean(int lane);

  int cells_ = 0;
  bool periodic_ = false;
  std::array<bool, 2> open_{};
  std::vector<double> work_;
};

}  // namespace eulastic
