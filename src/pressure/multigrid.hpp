// A multigrid V-cycle for lap q - shift q = rhs with zero normal derivative on some boundaries of the domain and 0 on
// others, where the ghosts of all fields are 0, the value on the boundary itself: a fixed linear operator, without
// global sums, the same bits on any number of ranks. Cf. Trottenberg, Oosterlee, Schuller, Multigrid, 2001.
//
// One relaxation before the coarse grid (never stored: it is folded into the restriction), a few after it with the
// steps of a Chebyshev polynomial; restriction by volume, linear interpolation; directions of unequal spacing are
// halved one after the other. Levels with too few cells for each rank are joined on fewer ranks, small ones gathered
// and continued by every rank for itself, down to one cell.
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"
#include "pressure/multigrid_level.hpp"

#include <functional>

namespace eulastic {

class Multigrid {
public:
  static constexpr int halo = 2;  ///< ghost layers of the right-hand side that a cycle reads

  using RowsDone = std::function<void(ConstView, int, int, int, int)>;

  /// Builds all levels, collectively; keeps no reference to `grid`.
  PetscErrorCode create(const Domain &domain) { return create(domain, domain.domain_shape().open); }
  PetscErrorCode create(const Domain &domain, const ZeroSides &zero);
  /// Sets the shift (1/length^2, not negative), which is 0 at first.
  void set_shift(double shift);
  /// A relaxation of the finest level from 0, undamped: q = step rhs.
  double step() const { return levels_.front()->step(); }
  /// solution = V rhs, about the q with lap q - shift q = rhs. `rhs`: `halo` ghost layers valid. `solution`: one ghost
  /// layer valid on return; `scratch` is lost. All on the grid. Ghosts behind boundaries with zero derivative are
  /// neither used (but must be finite) nor set; behind those where q is 0 they must be 0, of all three, as many as are
  /// exchanged, and stay so.
  /// In 3-D, where x wraps around, rows_done(solution, thread, j_begin, j_end, k), if given, is called for rows as soon
  /// as all owned ones around them have their last values, but for those at the ends of y and z.
  PetscErrorCode apply(const Field &rhs, Field &solution, Field &scratch, const RowsDone &rows_done = {});
  /// Floating-point operations of one cycle on this rank.
  double flops() const { return flops_; }
  std::size_t bytes() const;
  /// The levels of a grid, the finest first, without fields: each has half the cells of the one before it or, while
  /// these are too few for a rank, the same cells on fewer ranks, in the end all of them on every rank. `grid` may be
  /// Domain::planned.
  static std::vector<std::unique_ptr<MultigridLevel>> plan(const Domain &domain) {
    return plan(domain, domain.domain_shape().open);
  }
  static std::vector<std::unique_ptr<MultigridLevel>> plan(const Domain &domain, const ZeroSides &zero);
  /// How the levels of plan() are shared, for people: how many there are, and the cells from which on ranks are joined.
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
