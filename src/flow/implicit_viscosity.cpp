#include "flow/implicit_viscosity.hpp"

#include "base/events.hpp"
#include "base/one_line.hpp"
#include "flow/viscous_stress.hpp"
#include "grid/blocks.hpp"
#include "pressure/row_sums.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

const double share = 1 - std::sqrt(0.5);  // gamma of SDIRK2: the share of the step in each of its two systems
constexpr int most_iterations = 1000;     // for one system

using Row = const double *__restrict__;
using Target = double *__restrict__;

EULASTIC_CLONES void scale_row(int begin, int end, double factor, double slope_factor, Row slope, Target rate) {
#pragma omp simd
  for (int i = begin; i < end; ++i) rate[i] = factor * rate[i] + slope_factor * slope[i];
}
EULASTIC_CLONES void subtract_row(int begin, int end, Row of, Row less, Target out) {
#pragma omp simd
  for (int i = begin; i < end; ++i) out[i] = of[i] - less[i];
}
EULASTIC_CLONES void guess_row(int begin, int end, double factor, Row right_side, Row product, Target solution,
                               Target residual) {
#pragma omp simd
  for (int i = begin; i < end; ++i) {
    solution[i] *= factor;
    residual[i] = kernels::fma(-factor, product[i], right_side[i]);
  }
}
EULASTIC_CLONES void add_row(int begin, int end, double factor, Row more, Target out) {
#pragma omp simd
  for (int i = begin; i < end; ++i) out[i] = kernels::fma(factor, more[i], out[i]);
}

EULASTIC_CLONES void mean_row(int begin, int end, Row other, Target out) {
#pragma omp simd
  for (int i = begin; i < end; ++i) out[i] = 0.5 * (out[i] + other[i]);
}

struct Iteration {
  double along_last, step;  // beta, alpha
};
EULASTIC_CLONES void iterate_row(int begin, int end, Iteration c, Row correction, Row product, Target direction,
                                 Target direction_product, Target solution, Target residual) {
#pragma omp simd
  for (int i = begin; i < end; ++i) {
    const double d = kernels::fma(c.along_last, direction[i], correction[i]);
    const double Ad = kernels::fma(c.along_last, direction_product[i], product[i]);
    direction[i] = d;
    direction_product[i] = Ad;
    solution[i] = kernels::fma(c.step, d, solution[i]);
    residual[i] = kernels::fma(-c.step, Ad, residual[i]);
  }
}

bool moves(const BoundaryConditions &increments) {
  for (const auto &pair : increments)
    for (const BoundaryCondition &side : pair)
      if (side.motion.velocity != Real3{} || (side.kind == BoundaryKind::inflow && side.given.value != 0)) return true;
  return false;
}

// Returns where an increment of component a is 0: on closed boundaries, and on planes of symmetry normal to a.
ZeroSides zero_sides(const Box &box, const BoundaryConditions &sides, int a) {
  ZeroSides zero{};
  for (const auto [d, high] : box.sides()) {
    const BoundaryKind kind = sides[d][high].kind;
    zero[d][high] = is_solid(kind) || (kind == BoundaryKind::symmetry && a == d);
  }
  return zero;
}

}  // namespace

PetscErrorCode ImplicitViscosity::create(const Domain &domain, const BoundaryConditions &sides, double least,
                                         double largest, double tolerance) {
  PetscFunctionBeginUser;
  domain_ = &domain;
  viscosity_ = std::sqrt(least * largest);
  option_ = tolerance;
  contrast_ = largest / least;
  tolerance_ = std::min(tolerance, 0.1 * std::sqrt(least / largest));
  const int dim = domain.dimension();
  for (int a = 0; a < dim; ++a) {
    boundaries_[a] = zero_sides(domain, sides, a);
    if (cycles_.count(boundaries_[a]) == 0) PetscCall(cycles_[boundaries_[a]].create(domain, boundaries_[a]));
  }
  for (Field *field : {&residual_, &correction_, &product_, &direction_, &direction_product_})
    *field = Field(domain, dim);
  for (Field *field : {&cycle_, &shifted_, &scratch_}) *field = Field(domain, 1);
  const auto is_given = [&](int a) { return domain.touches_low(a) && !domain.is_open(a, false); };
  for (const Segment &row : domain.rows())
    for (int a = 0; a < dim; ++a) {
      if ((a == 1 && row.j == 0 && is_given(1)) || (a == 2 && row.k == 0 && is_given(2))) continue;
      const bool beyond = a == 0 && domain.is_open(0, true) && domain.touches_high(0);
      faces_.push_back({a, {a == 0 && is_given(0) ? 1 : 0, row.i_end + beyond, row.j, row.k}});
    }
  for (int a = 1; a < dim; ++a)
    for (const Segment &row : domain.open_high_faces(a)) faces_.push_back({a, row});
  PetscFunctionReturn(0);
}

std::size_t ImplicitViscosity::bytes() const {
  std::size_t sum = cycle_.bytes() + shifted_.bytes() + scratch_.bytes();
  for (const auto &[boundaries, cycle] : cycles_) sum += cycle.bytes();
  for (const Field *field : {&residual_, &correction_, &product_, &direction_, &direction_product_})
    sum += field->bytes();
  return sum;
}

template <class Work>
void ImplicitViscosity::for_faces(const Work &work) const {
  const int parts = row_parts(*domain_);
  in_parallel(parts, parts, [&](int part) {
    const Piece piece(faces_.size(), part, parts);
    for (std::size_t f = piece.begin; f < piece.end; ++f) work(faces_[f].a, faces_[f].row);
  });
}

// Computes N sums over all faces of all ranks. product(a, row) returns a function (i, add) that calls add(s, x, y) to
// add the product x y to sum s.
template <int N, class Product>
PetscErrorCode ImplicitViscosity::sum(const Product &product, double *result) {
  PetscFunctionBeginUser;
  const int parts = row_parts(*domain_);
  std::vector<ExactSums> sums(parts, ExactSums(N));
  const std::int64_t begin = domain_->layout().begin[0];
  in_parallel(parts, parts, [&](int part) {
    const Piece piece(faces_.size(), part, parts);
    for (std::size_t f = piece.begin; f < piece.end; ++f) {
      const Segment &row = faces_[f].row;
      const auto row_product = product(faces_[f].a, row);
      add_row_sums<N>(
          row.size(), begin + row.i_begin,
          [&, first = row.i_begin](int i, auto add) EULASTIC_BODY { row_product(first + i, add); }, sums[part]);
    }
  });
  PetscCall(reduce_parts(domain_->comm(), sums, result));
  PetscFunctionReturn(0);
}

PetscErrorCode ImplicitViscosity::sum_of_squares(const Field &field, double *result) {
  PetscFunctionBeginUser;
  PetscCall(sum<1>(
      [&](int a, const Segment &row) {
        return [q = field[a].row(row.j, row.k)](int i, auto add) EULASTIC_BODY { add(0, q[i], q[i]); };
      },
      result));
  PetscFunctionReturn(0);
}

// Multiplies the faces on open boundaries by a factor. They have half a control volume, and with 1/2 as their weight
// the operator is symmetric.
void ImplicitViscosity::weight_open_faces(double factor, Field &field) const {
  for (int a = 0; a < domain_->dimension(); ++a)
    for (const bool high : {false, true}) {
      if (!domain_->is_open(a, high)) continue;
      for (const Segment &row : domain_->boundary_faces(a, high)) {
        double *values = field[a].row(row.j, row.k);
        for (int i = row.i_begin; i < row.i_end; ++i) values[i] *= factor;
      }
    }
}

// Sets correction = V residual, an approximate solution of (lap - 1/(part nu)) correction = residual. A V-cycle treats
// the faces of component a as cells, face i as cell i, which is not symmetric along a. Its mean with a V-cycle that
// treats face i + 1 as cell i is symmetric, so that mirrored scenes have mirrored results.
PetscErrorCode ImplicitViscosity::precondition(GhostExchange &exchange) {
  PetscFunctionBeginUser;
  PetscCall(exchange.update_ghosts(residual_, Multigrid::halo));
  for (int a = 0; a < domain_->dimension(); ++a) {
    Multigrid &cycle = cycles_[boundaries_[a]];
    const int end = domain_->cells()[a];
    const std::ptrdiff_t next = residual_[a].stride(a);
    PetscCall(cycle.apply(residual_.part(a, 1), cycle_, scratch_));
    for_faces([&](int component, const Segment &row) {
      if (component == a) copy_cycle(a, row, end, 0, cycle.step(), correction_[a].row(row.j, row.k));
    });
    in_segment_parts(domain_->rows(), *domain_, [&](const Segment *begin, const Segment *last) {
      for (const Segment *row = begin; row < last; ++row) {
        const double *from = residual_[a].row(row->j, row->k) + next;
        std::copy(from + row->i_begin, from + row->i_end, shifted_[0].row(row->j, row->k) + row->i_begin);
      }
    });
    PetscCall(exchange.update_ghosts(shifted_, Multigrid::halo));
    PetscCall(cycle.apply(shifted_, cycle_, scratch_));
    flops_ += 2 * cycle.flops();
    for_faces([&](int component, const Segment &row) {
      if (component != a) return;
      thread_local std::vector<double> other;
      other.resize(row.i_end);
      copy_cycle(a, row, domain_->touches_low(a) && domain_->is_open(a, false) ? 0 : -1, -next, cycle.step(),
                 other.data());
      mean_row(row.i_begin, row.i_end, other.data(), correction_[a].row(row.j, row.k));
    });
  }
  PetscFunctionReturn(0);
}

// Copies a V-cycle's result to the faces of component a in a row, from cells `offset` values away. Faces with the index
// `alone` along a have no cell: one relaxation replaces the V-cycle there.
void ImplicitViscosity::copy_cycle(int a, const Segment &row, int alone, std::ptrdiff_t offset, double relaxation,
                                   double *to) const {
  const double *from = cycle_[0].row(row.j, row.k) + offset, *r = residual_[a].row(row.j, row.k);
  const bool whole_row = (a == 1 && row.j == alone) || (a == 2 && row.k == alone);
  for (int i = row.i_begin; i < row.i_end; ++i)
    to[i] = whole_row || (a == 0 && i == alone) ? relaxation * r[i] : from[i];
}

// Computes product = (1 - part L) correction.
PetscErrorCode ImplicitViscosity::multiply(GhostExchange &exchange, const ViscousStep &step, double part) {
  PetscFunctionBeginUser;
  ++products_;
  PetscCall(exchange.update_ghosts(correction_, 2));
  fill_wall_ghosts_velocity(*domain_, sides_of_increment(step.sides, step.time, step.time), 0, correction_, 2);
  for_faces([&](int a, const Segment &row) {
    const double *from = correction_[a].row(row.j, row.k);
    std::copy(from + row.i_begin, from + row.i_end, product_[a].row(row.j, row.k) + row.i_begin);
  });
  PetscCall(add_viscous_force(*domain_, *step.local, -part, correction_, product_));
  weight_open_faces(0.5, product_);
  PetscFunctionReturn(0);
}

// Adds part times the viscous force of the increments of the boundaries' velocities between two times.
PetscErrorCode ImplicitViscosity::add_boundaries(GhostExchange &exchange, const ViscousStep &step, double from,
                                                 double to, double part, Field &right_side) {
  PetscFunctionBeginUser;
  const BoundaryConditions increments = sides_of_increment(step.sides, from, to);
  if (!moves(increments)) PetscFunctionReturn(0);
  ++products_;
  correction_.clear();
  PetscCall(exchange.update_ghosts(correction_, 2));
  fill_wall_ghosts_velocity(*domain_, increments, 0, correction_, 2);
  PetscCall(add_viscous_force(*domain_, *step.local, part, correction_, right_side));
  PetscFunctionReturn(0);
}

// Sets up Y_1 - part L Y_1 = part (M_0 + (share - 1/2) dt M_1), with the initial guess Y_1 = 0.
PetscErrorCode ImplicitViscosity::first_system(GhostExchange &exchange, const ViscousStep &step, double part,
                                               Field &rate, const Field *slope, Size *size) {
  PetscFunctionBeginUser;
  for_faces([&](int a, const Segment &row) {
    double *b = rate[a].row(row.j, row.k);
    scale_row(row.i_begin, row.i_end, part, slope ? part * (share - 0.5) * step.dt : 0,
              slope ? (*slope)[a].row(row.j, row.k) : b, b);
  });
  PetscCall(add_boundaries(exchange, step, step.time, step.time + part, part, rate));
  weight_open_faces(0.5, rate);
  for_faces([&](int a, const Segment &row) {
    const double *b = rate[a].row(row.j, row.k);
    std::copy(b + row.i_begin, b + row.i_end, residual_[a].row(row.j, row.k) + row.i_begin);
  });
  PetscCall(sum_of_squares(rate, &size->right_side));
  size->residual = size->right_side;
  PetscFunctionReturn(0);
}

// Sets up Y_2 - part L Y_2 = (1 - share)/share Y_1 + part (M_0 + dt/2 M_1). The initial guess is the multiple of Y_1
// with the least error in the norm of the operator.
PetscErrorCode ImplicitViscosity::second_system(GhostExchange &exchange, const ViscousStep &step, double part,
                                                Field &rate, const Field *slope, Field &solution, Size *size) {
  PetscFunctionBeginUser;
  for_faces([&](int a, const Segment &row) {
    const auto at = [&](Field &field) { return field[a].row(row.j, row.k); };
    subtract_row(row.i_begin, row.i_end, at(rate), at(residual_), at(product_));
  });
  weight_open_faces(2, rate);
  for_faces([&](int a, const Segment &row) {
    double *b = rate[a].row(row.j, row.k);
    add_row(row.i_begin, row.i_end, (1 - share) / share, solution[a].row(row.j, row.k), b);
    if (slope) add_row(row.i_begin, row.i_end, part * (1 - share) * step.dt, (*slope)[a].row(row.j, row.k), b);
  });
  PetscCall(add_boundaries(exchange, step, step.time + part, step.time + step.dt, part, rate));
  weight_open_faces(0.5, rate);
  double sums[2];
  PetscCall(sum<2>(
      [&](int a, const Segment &row) {
        const auto at = [&](const Field &field) { return field[a].row(row.j, row.k); };
        return [y = at(solution), b = at(rate), Ay = at(product_)](int i, auto add) EULASTIC_BODY {
          add(0, y[i], b[i]);
          add(1, y[i], Ay[i]);
        };
      },
      sums));
  const double factor = sums[1] > 0 ? sums[0] / sums[1] : 0;
  for_faces([&](int a, const Segment &row) {
    const auto at = [&](Field &field) { return field[a].row(row.j, row.k); };
    guess_row(row.i_begin, row.i_end, factor, at(rate), at(product_), at(solution), at(residual_));
  });
  PetscCall(sum_of_squares(rate, &size->right_side));
  PetscCall(sum_of_squares(residual_, &size->residual));
  PetscFunctionReturn(0);
}

// What is accepted instead. A larger -viscous_tolerance helps only where it is not already limited by the contrast.
std::string ImplicitViscosity::advice(double dt) const {
  const bool limited = tolerance_ < option_;
  std::string text = print("the tolerance is %.3g, ", tolerance_);
  text += limited ? "the most at this contrast of viscosities" : "-viscous_tolerance";
  text += print("; accepted: a shorter -time_step (now %.3g), a contrast of viscosities below %.3g, ", dt, contrast_);
  return text + (limited ? "" : "a larger -viscous_tolerance, ") + "or -viscous_scheme rkl";
}

// Conjugate gradients. Since the V-cycle is not exactly symmetric, they are flexible (Notay 2000): each direction is
// made conjugate to the one before explicitly.
PetscErrorCode ImplicitViscosity::solve(GhostExchange &exchange, const ViscousStep &step, double part, Size size,
                                        Field &solution) {
  PetscFunctionBeginUser;
  const double enough = tolerance_ * tolerance_ * size.right_side;
  constexpr int flops_of_iteration = 20;  // per face: sums, directions, solution, residual
  double last = 0;                        // of the last direction d, d . A d
  direction_.clear();
  direction_product_.clear();
  for (int n = 0; n < most_iterations && size.residual > enough; ++n) {
    PetscCall(precondition(exchange));
    PetscCall(multiply(exchange, step, part));
    double sums[3];
    PetscCall(sum<3>(
        [&](int a, const Segment &row) {
          const auto at = [&](const Field &field) { return field[a].row(row.j, row.k); };
          return [z = at(correction_), Az = at(product_), Ad = at(direction_product_), r = at(residual_)](
                     int i, auto add) EULASTIC_BODY {
            add(0, z[i], Az[i]);
            add(1, z[i], Ad[i]);
            add(2, z[i], r[i]);
          };
        },
        sums));
    const double along_last = last > 0 ? -sums[1] / last : 0;
    last = sums[0] + along_last * sums[1];
    if (!(last > 0)) break;  // underflow: no more can be gained
    const double factor = sums[2] / last;
    for_faces([&](int a, const Segment &row) {
      const auto at = [&](Field &field) { return field[a].row(row.j, row.k); };
      iterate_row(row.i_begin, row.i_end, {along_last, factor}, at(correction_), at(product_), at(direction_),
                  at(direction_product_), at(solution), at(residual_));
    });
    PetscCall(sum_of_squares(residual_, &size.residual));
    flops_ += flops_of_iteration * domain_->cell_count() * domain_->dimension();
  }
  if (size.residual > enough)
    SETERRQ(domain_->comm(), PETSC_ERR_NOT_CONVERGED,
            "the implicit viscous step did not converge in %d iterations: the residual is %.3g of the right-hand side, "
            "and %s",
            most_iterations, std::sqrt(size.residual / size.right_side), advice(step.dt).c_str());
  PetscFunctionReturn(0);
}

PetscErrorCode ImplicitViscosity::step(GhostExchange &exchange, const ViscousStep &step, Field &rate,
                                       const Field *slope, Field &velocity_star) {
  PetscFunctionBeginUser;
  EventScope scope(Event::viscous);
  const int dim = domain_->dimension();
  const double part = share * step.dt;
  Size size{};
  products_ = 0;
  flops_ = 0;
  for (auto &[boundaries, cycle] : cycles_) cycle.set_shift(1 / (part * viscosity_));
  Field solution = velocity_star.part(0, dim);
  solution.clear();
  PetscCall(first_system(exchange, step, part, rate, slope, &size));
  PetscCall(solve(exchange, step, part, size, solution));
  PetscCall(second_system(exchange, step, part, rate, slope, solution, &size));
  PetscCall(solve(exchange, step, part, size, solution));
  for (int a = 0; a < dim; ++a) {
    std::vector<Segment> rows = domain_->rows();
    for (Segment &row : rows) row.i_end += a == 0 && domain_->is_open(0, true) && domain_->touches_high(0);
    if (a > 0)
      for (const Segment &row : domain_->open_high_faces(a)) rows.push_back(row);
    in_segment_parts(rows, *domain_, [&](const Segment *begin, const Segment *end) {
      for (const Segment *row = begin; row < end; ++row)
        add_row(row->i_begin, row->i_end, 1, step.velocity[a].row(row->j, row->k), solution[a].row(row->j, row->k));
    });
  }
  scope.flops(flops_);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
