// The pressure increment where rigid bodies close faces: D* is made 0 through the open ones alone.
//
// Conjugate gradients for div(open grad q) = D*/dt, with any other solver, which sees no bodies, as the preconditioner:
// flexible, as that one may stop early (Notay, SIAM J. Sci. Comput. 22, 2000).
#pragma once

#include "base/petsc.hpp"
#include "field/ghost_exchange.hpp"
#include "field/rigid_faces.hpp"
#include "field/work_space.hpp"
#include "grid/domain.hpp"
#include "pressure/increment_memory.hpp"
#include "pressure/pressure_solver.hpp"

#include <cstdint>

namespace eulastic {

class ObstacleSolver final : public PressureSolver {
public:
  static constexpr int work_fields = 4;  ///< of the work space, during a solve, beside those of the other solver
  static constexpr int most_iterations = 100;

  /// `accuracy`: of the target that is asked for, 1 or less. `memory`: increments of earlier steps that are directions
  /// to begin with. All must outlive the solver.
  ObstacleSolver(const Domain &domain, GhostExchange &exchange, WorkSpace &work, const RigidFaces &faces,
                 double accuracy, int memory, std::unique_ptr<PressureSolver> other);
  /// The faces have changed: bodies travel.
  void follow(const RigidFaces &faces);
  /// Cells whose faces are all closed get what the pressure around them is, two layers deep: nothing corrects it there,
  /// and where a body moves away it is what the fluid begins with. All of a ghost layer. Collective.
  PetscErrorCode extend(Field &pressure) const;
  /// D* of cells beside bodies becomes that of a whole cell, for the rotational update of p, which takes `part` of what
  /// is wrong in a step (docs/method.md, section 19). All of a ghost layer. Collective.
  PetscErrorCode spread(double part, Field &divergence) const;
  /// Owned cells whose faces are all closed get the values of another field.
  void copy_closed(const Field &from, Field *to) const;
  PetscErrorCode solve(double dt, const Field &divergence, Field &pressure, Field &increment) override;
  void set_target(double rms) override { target_ = accuracy_ * rms; }
  long sweeps() const override { return iterations_; }
  double sound_speed() const override { return other_->sound_speed(); }
  /// The last increments, the newest first, or null. Whoever asks may write its owned cells.
  Field *memory() override { return memory_.saved(); }
  void clear_memory() override { memory_.clear(); }
  std::size_t bytes() const override;

private:
  /// Cell i of a row, and how far its faces are open: low, high along x, then y, z.
  struct Beside {
    int i;
    double open[6];
    double response = 0;  ///< r of docs/method.md, section 19
    bool closed() const;
  };
  void apply(double dt, const Field &q, Field &out) const;
  /// Calls work(cell, row) for every owned cell with faces that are not open.
  template <class Work>
  void for_beside(const Work &work) const;
  /// Calls work(cell) for every owned cell whose faces are all closed.
  template <class Work>
  void for_closed_cells(const Work &work) const;
  PetscErrorCode normalise(const Field &pressure, Field &increment);
  PetscErrorCode add_local(double dt, const Field &residual, Field &correction) const;
  PetscErrorCode products(const Field &a, const Field &b, const Field &c, const Field &d, double *ab, double *cd) const;

  const Domain *domain_;
  GhostExchange *exchange_;
  WorkSpace *work_;
  std::unique_ptr<PressureSolver> other_;
  std::vector<Beside> cells_;
  std::vector<std::size_t> first_;  ///< of every owned row, and the end
  bool travels_ = false;
  std::int64_t closed_count_ = -1;  ///< cells of the box whose faces are all closed; -1: not counted yet
  IncrementMemory memory_;
  double accuracy_, target_ = 0;
  long iterations_ = 0;
};

template <class Work>
void ObstacleSolver::for_beside(const Work &work) const {
  std::size_t at = 0;
  for (const Segment &row : domain_->rows()) {
    for (std::size_t c = first_[at]; c < first_[at + 1]; ++c) work(cells_[c], row);
    ++at;
  }
}

template <class Work>
void ObstacleSolver::for_closed_cells(const Work &work) const {
  for_beside([&](const Beside &cell, const Segment &row) {
    if (cell.closed()) work(Int3{cell.i, row.j, row.k});
  });
}

}  // namespace eulastic
