// A multigrid V-cycle for lap q - shift q = rhs with zero normal derivative on some boundaries and value 0 on others,
// whose ghosts hold this value, 0. It is a fixed linear operator without global sums, with the same bits on any number
// of ranks. Cf. Trottenberg, Oosterlee, Schuller, Multigrid, 2001.
//
// One relaxation comes before the coarse grid (never stored, but folded into the restriction), several after it, with
// the steps of a Chebyshev polynomial. Restriction is by volume, interpolation linear. Directions of unequal spacing
// are halved one after the other. Levels with too few cells per rank are moved to fewer ranks, small ones are gathered,
// and every rank continues redundantly down to one cell.
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"
#include "pressure/multigrid_level.hpp"

#include <functional>

namespace eulastic {

class Multigrid {
public:
  static constexpr int halo = 2;  ///< ghost layers of the right-hand side that a cycle reads
  /// Memory of all levels, in fields of the grid, about.
  static constexpr double fields(int dimension) { return dimension == 2 ? 1 : 0.4; }

  /// Arguments of apply()'s callback.
  using RowsDone = std::function<void(ConstView, int, int, int, int)>;

  /// Builds all levels, with q = 0 on the open boundaries; keeps no reference to `domain`. Collective.
  PetscErrorCode create(const Domain &domain) { return create(domain, domain.domain_shape().open); }
  /// The same with q = 0 on other boundaries.
  PetscErrorCode create(const Domain &domain, const ZeroSides &zero);
  /// Sets the shift (1/length^2, not negative), which is 0 at first.
  void set_shift(double shift);
  /// The step of an undamped relaxation of the finest level from 0, q = step rhs.
  double step() const { return levels_.front()->step(); }
  /// Computes solution = V rhs, an approximation of the q with lap q - shift q = rhs, on the finest grid. `rhs` needs
  /// `halo` valid ghost layers; `solution` has one on return; `scratch` is overwritten. Ghosts behind boundaries with
  /// zero derivative are neither used (but must be finite) nor set; behind boundaries with q = 0 they must be 0 in all
  /// three fields, in all layers that are exchanged, and stay 0. In 3-D, if x wraps around, rows_done(solution, thread,
  /// j_begin, j_end, k), if given, is called for rows once all owned rows around them have their final values, except
  /// for those at the ends of y and z.
  PetscErrorCode apply(const Field &rhs, Field &solution, Field &scratch, const RowsDone &rows_done = {});
  /// Floating-point operations of one cycle on this rank.
  double flops() const { return flops_; }
  std::size_t bytes() const;
  /// The levels of a grid, finest first, without fields. Each level has half the cells of the one before; or the same
  /// cells on fewer ranks, if half would be too few for a rank; or the same cells on every rank. `domain` may be
  /// Domain::planned.
  static std::vector<std::unique_ptr<MultigridLevel>> plan(const Domain &domain) {
    return plan(domain, domain.domain_shape().open);
  }
  static std::vector<std::unique_ptr<MultigridLevel>> plan(const Domain &domain, const ZeroSides &zero);
  /// A text on how the levels of plan() are distributed: their number, and the sizes from which they are on fewer
  /// ranks.
  static std::string shares(const Domain &domain);
  struct Relaxations;

private:
  using Level = std::unique_ptr<MultigridLevel>;
  PetscErrorCode cycle(std::size_t l, const Field &rhs, Field &solution, Field &scratch, const RowsDone &rows_done);
  const Relaxations &relaxations(const MultigridLevel &level) const;
  static int halo_of(const MultigridLevel &level);
  void restrict_residual(const MultigridLevel &fine, const Field &rhs, MultigridLevel &coarse);
  PetscErrorCode smooth(MultigridLevel &fine, MultigridLevel &coarse, const Field &rhs, Field &solution, Field &scratch,
                        const RowsDone &rows_done);

  std::vector<Level> levels_;  ///< the finest first
  double flops_ = 0;
};

}  // namespace eulastic
