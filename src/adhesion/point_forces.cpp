#include "adhesion/point_forces.hpp"

#include "adhesion/grid_place.hpp"
#include "base/exact_sum.hpp"
#include "base/send_to_ranks.hpp"
#include "grid/cell_ranks.hpp"

#include <algorithm>
#include <tuple>

namespace eulastic {

PetscErrorCode PointForces::set(std::vector<PointForce> forces) {
  const Domain &domain = flow_.domain;
  std::vector<int> to;
  PetscFunctionBeginUser;
  forces_.clear();
  for (const PointForce &force : forces) {
    Int3 begin{}, end{1, 1, 1};
    for (int d = 0; d < domain.dimension(); ++d) {
      const int cell = static_cast<int>(std::floor(force.place[d] / domain.spacing()[d]));
      begin[d] = cell - 1;
      end[d] = cell + 2;
    }
    for (const int rank : ranks_over(domain, begin, end)) {
      forces_.push_back(force);
      to.push_back(rank);
    }
  }
  PetscCall(send_to_ranks(domain.comm(), to, &forces_));
  std::sort(forces_.begin(), forces_.end(), [](const PointForce &one, const PointForce &other) {
    return std::tie(one.body, one.receptor, one.point) < std::tie(other.body, other.receptor, other.point);
  });
  PetscFunctionReturn(0);
}

// Calls visit(offset of an owned face in the component, weight) for the faces of component a around a point. The
// weights are those of the interpolation of the velocity, so that the power of a force is its work on the flow. A face
// behind a boundary stands for its mirror image with the sign of the velocity there; faces on walls get no force.
template <class Visit>
void PointForces::for_faces(const PointForce &force, int a, const Visit &visit) const {
  const Domain &domain = flow_.domain;
  const Layout &layout = domain.layout();
  LinearPoints(domain, at_face[a], force.place.data()).for_all([&](const LinearPoints::Point &point) {
    Int3 at = point.at;
    double weight = point.weight;
    for (int d = 0; d < domain.dimension(); ++d) {
      const int cells = domain.domain_cells()[d];
      if (!domain.is_wall(d)) {
        at[d] = domain.image(d, at[d]);
      } else if (d == a) {
        if (at[d] < 1 || at[d] >= cells) return;
      } else if (at[d] < 0 || at[d] >= cells) {
        if (is_solid(flow_.spec.sides[d][at[d] >= cells].kind)) weight = -weight;
        at[d] = at[d] < 0 ? -1 - at[d] : 2 * cells - 1 - at[d];
      }
      at[d] -= layout.begin[d];
      if (at[d] < 0 || at[d] >= layout.cells[d]) return;
    }
    visit(at, weight);
  });
}

void PointForces::add(const std::vector<WeightedTarget> &targets) const {
  const double per_mass = 1 / (flow_.fluid.density * flow_.domain.cell_volume());
  for (const PointForce &force : forces_)
    for (int a = 0; a < flow_.domain.dimension(); ++a)
      for_faces(force, a, [&](const Int3 &at, double weight) {
        for (const WeightedTarget &target : targets)
          (*target.field)[a](at[0], at[1], at[2]) += target.factor * per_mass * weight * force.force[a];
      });
}

void PointForces::mark_rows(std::vector<char> *rows) const {
  const std::size_t deep = flow_.domain.layout().cells[1];
  for (const PointForce &force : forces_)
    for (int a = 0; a < flow_.domain.dimension(); ++a)
      for_faces(force, a, [&](const Int3 &at, double) { (*rows)[at[1] + deep * at[2]] = 1; });
}

PetscErrorCode PointForces::add_power(double *power) const {
  const Domain &domain = flow_.domain;
  ExactSums sum(1);
  double own = 0;
  PetscFunctionBeginUser;
  for (const PointForce &force : forces_) {
    const GridPlace place(domain, force.place);
    if (place.owner(domain) != domain.rank()) continue;
    const Real3 velocity = place.velocity(domain, flow_.now.velocity, force.place);
    for (int d = 0; d < domain.dimension(); ++d) sum.add(0, force.force[d] * velocity[d]);
  }
  PetscCall(sum.reduce(domain.comm(), &own));
  *power += own;
  PetscFunctionReturn(0);
}

}  // namespace eulastic
