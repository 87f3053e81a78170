// An implicit viscous step where viscosity varies: SDIRK2, each of its two systems solved by conjugate gradients,
// preconditioned by V-cycles of a uniform viscosity (docs/method.md, section 16).
#pragma once

#include "base/exact_sum.hpp"
#include "flow/super_time_stepping.hpp"
#include "pressure/multigrid.hpp"

#include <map>
#include <string>

namespace eulastic {

/// The viscous part of a step as a whole, in place of the stages of super_time_step().
class ImplicitViscosity {
public:
  /// Memory in fields of the grid.
  static double fields(int dimension) { return 5 * dimension + 3 + Multigrid::fields(dimension); }
  /// Builds the V-cycles for increments of the velocity, which are 0 on closed boundaries, with the geometric mean of
  /// the `least` and the `largest` kinematic viscosity. `tolerance`: of the residual of each system, relative to its
  /// right-hand side; at most .1 sqrt(least/largest), because with large contrasts the residual hides errors where the
  /// viscosity is least. Collective.
  PetscErrorCode create(const Domain &domain, const BoundaryConditions &sides, double least, double largest,
                        double tolerance);
  /// v* = v + W(dt) like super_time_step(), from `step.local`; `step.rigid` must be null. `rate`: M_0, overwritten.
  /// `slope`: M_1, or null. Fails if a system does not converge. Collective.
  PetscErrorCode step(GhostExchange &exchange, const ViscousStep &step, Field &rate, const Field *slope,
                      Field &velocity_star);
  /// The number of evaluations of the viscous force in the last step.
  int products() const { return products_; }
  std::size_t bytes() const;

private:
  /// The faces of component a in a row whose velocity is not given.
  struct Faces {
    int a;
    Segment row;
  };
  struct Size {
    double right_side, residual;  ///< sums of squares
  };
  template <class Work>
  void for_faces(const Work &work) const;
  template <int N, class Product>
  PetscErrorCode sum(const Product &product, double *result);
  PetscErrorCode sum_of_squares(const Field &field, double *result);
  void weight_open_faces(double factor, Field &field) const;
  PetscErrorCode precondition(GhostExchange &exchange);
  void copy_cycle(int a, const Segment &row, int alone, std::ptrdiff_t offset, double relaxation, double *to) const;
  PetscErrorCode multiply(GhostExchange &exchange, const ViscousStep &step, double part);
  PetscErrorCode add_boundaries(GhostExchange &exchange, const ViscousStep &step, double from, double to, double part,
                                Field &right_side);
  PetscErrorCode first_system(GhostExchange &exchange, const ViscousStep &step, double part, Field &rate,
                              const Field *slope, Size *size);
  PetscErrorCode second_system(GhostExchange &exchange, const ViscousStep &step, double part, Field &rate,
                               const Field *slope, Field &solution, Size *size);
  PetscErrorCode solve(GhostExchange &exchange, const ViscousStep &step, double part, Size size, Field &solution);
  std::string advice(double dt) const;  ///< where solve() does not converge

  const Domain *domain_ = nullptr;
  double viscosity_ = 0;  ///< of the V-cycles
  double option_ = 0;     ///< -viscous_tolerance
  double contrast_ = 1;   ///< largest over least viscosity
  double tolerance_ = 0;  ///< of the residual, relative to the right-hand side; smaller for large contrasts
  double flops_ = 0;      ///< of the last step, without the viscous forces
  int products_ = 0;
  std::vector<Faces> faces_;
  std::map<ZeroSides, Multigrid> cycles_;  ///< of all components with the same boundaries
  std::array<ZeroSides, 3> boundaries_{};  ///< of every component
  Field residual_, correction_, product_, direction_, direction_product_;  ///< velocity blocks; ghosts behind sides of
                                                                           ///< the residual are 0
  Field cycle_, shifted_, scratch_;
};

}  // namespace eulastic
