// The pressure increment with rigid bodies: the divergence is removed by the flow through open faces alone.
//
// Solves div(open grad q) = D*/dt by conjugate gradients, preconditioned by any other solver, which does not know the
// bodies. They are flexible, because this solver may stop early (Notay, SIAM J. Sci. Comput. 22, 2000).
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
  /// Components of the work space during a solve, in addition to those of the preconditioner.
  static constexpr int work_fields = 4;
  static constexpr int most_iterations = 100;

  /// `accuracy`: factor, at most 1, of the target given to set_target(). `memory`: number of increments of earlier
  /// steps that are used as first directions. `preconditioner` solves without bodies. The references must outlive the
  /// solver.
  ObstacleSolver(const Domain &domain, GhostExchange &exchange, WorkSpace &work, const RigidFaces &faces,
                 double accuracy, int memory, std::unique_ptr<PressureSolver> preconditioner);
  /// Rebuilds the cells beside bodies after the faces have changed, if bodies travel.
  void update_faces(const RigidFaces &faces);
  /// Extrapolates the pressure to cells whose faces are all closed, in two layers. No increment acts on it there, and
  /// when a body moves away the fluid begins with it. Updates one ghost layer. Collective.
  PetscErrorCode extrapolate_into_closed(Field &pressure) const;
  /// Divides D* in cells beside bodies by their reduced response, for the rotational update of p, which removes `part`
  /// of the error in a step (docs/method.md, section 19). Updates one ghost layer. Collective.
  PetscErrorCode scale_divergence(double part, Field &divergence) const;
  /// Copies the values of owned cells whose faces are all closed from one field to another.
  void copy_closed(const Field &from, Field *to) const;
  PetscErrorCode solve(double dt, const Field &divergence, Field &pressure, Field &increment) override;
  void set_target(double rms) override { target_ = accuracy_ * rms; }
  long sweeps() const override { return iterations_; }
  double sound_speed() const override { return preconditioner_->sound_speed(); }
  /// The increments of the last steps, newest first, or null. The caller may write their owned cells.
  Field *memory() override { return memory_.saved(); }
  void clear_memory() override { memory_.clear(); }
  std::size_t bytes() const override;

private:
  /// Cell i of a row with a closed or cut face. `open`: openness of its faces, low and high along x, then y, z.
  struct CellAtBody {
    int i;
    double open[6];
    double response = 0;  ///< r of docs/method.md, section 19
    bool closed() const;
  };
  void apply(double dt, const Field &q, Field &out) const;
  /// Calls work(cell, row) for every owned cell with faces that are not open.
  template <class Work>
  void for_cells_at_bodies(const Work &work) const;
  /// Calls work(cell) for every owned cell whose faces are all closed.
  template <class Work>
  void for_closed_cells(const Work &work) const;
  PetscErrorCode normalise(const Field &pressure, Field &increment);
  PetscErrorCode add_diagonal_correction(double dt, const Field &residual, Field &correction) const;
  PetscErrorCode products(const Field &a, const Field &b, const Field &c, const Field &d, double *ab, double *cd) const;

  const Domain *domain_;
  GhostExchange *exchange_;
  WorkSpace *work_;
  std::unique_ptr<PressureSolver> preconditioner_;
  std::vector<CellAtBody> cells_;
  std::vector<std::size_t> first_;  ///< first cell of every owned row, and the end
  bool travels_ = false;
  std::int64_t closed_count_ = -1;  ///< cells of the box whose faces are all closed; -1: not counted yet
  IncrementMemory memory_;
  double accuracy_, target_ = 0;
  long iterations_ = 0;
};

template <class Work>
void ObstacleSolver::for_cells_at_bodies(const Work &work) const {
  std::size_t at = 0;
  for (const Segment &row : domain_->rows()) {
    for (std::size_t c = first_[at]; c < first_[at + 1]; ++c) work(cells_[c], row);
    ++at;
  }
}

template <class Work>
void ObstacleSolver::for_closed_cells(const Work &work) const {
  for_cells_at_bodies([&](const CellAtBody &cell, const Segment &row) {
    if (cell.closed()) work(Int3{cell.i, row.j, row.k});
  });
}

}  // namespace eulastic
