#include "openings/inlet_generators.hpp"

#include "base/exact_sum.hpp"
#include "base/send_to_ranks.hpp"
#include "bodies/labels.hpp"
#include "field/inlet_velocity.hpp"
#include "field/open_boundaries.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

InletGenerators::~InletGenerators() {
  for (Stretch &stretch : stretches_) (void)MPI_Comm_free(&stretch.line);
}

PetscErrorCode InletGenerators::create() {
  const Domain &domain = flow_.domain;
  const BoundaryConditions &sides = flow_.spec.sides;
  PetscFunctionBeginUser;
  const Int3 position = domain.split().position_of(domain.rank());
  for (int d = 0; d < domain.dimension(); ++d)
    for (const int high : {0, 1}) {
      if (sides[d][high].generator_cells == 0) continue;
      Int3 first = position;
      first[d] = 0;
      MPI_Comm line;
      PetscCallMPI(MPI_Comm_split(domain.comm(), domain.split().rank_at(first), position[d], &line));
      stretches_.push_back({d, high, sides[d][high].generator_cells, line});
    }
  PetscFunctionReturn(0);
}

template <class Visit>
void InletGenerators::for_cells(const Box &box, const Stretch &stretch, const Visit &visit) {
  const int d = stretch.d, deep = stretch.cells + beyond, begin = box.layout().begin[d];
  Int3 from{}, to = box.cells();
  if (stretch.high)
    from[d] = std::max(0, box.domain_cells()[d] - deep - begin);
  else
    to[d] = std::min(to[d], deep - begin);
  for_points({from, to}, visit);
}

// Rigid bodies are the same all along a stretch.
PetscErrorCode InletGenerators::check_lumen() const {
  constexpr double same = 0.05;  // of a solid fraction; surfaces of triangles and voxels are not quite straight
  std::vector<double> change(stretches_.size(), 0);
  PetscFunctionBeginUser;
  for (std::size_t s = 0; s < stretches_.size(); ++s)
    for (const Phase &phase : flow_.now.phases) {
      if (!phase.material.is_rigid()) continue;
      const ConstView phi = phase.fraction[0];
      const std::ptrdiff_t next = (stretches_[s].high ? -1 : 1) * phi.stride(stretches_[s].d);
      for_cells(flow_.domain, stretches_[s], [&](int i, int j, int k) {
        const double *here = &phi(i, j, k);
        change[s] = std::max(change[s], std::fabs(here[next] - here[0]));
      });
    }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, change.data(), static_cast<int>(change.size()), MPI_DOUBLE, MPI_MAX,
                             flow_.domain.comm()));
  for (std::size_t s = 0; s < stretches_.size(); ++s)
    if (change[s] > same)
      flow_.stop_reason =
          "-boundary_" + side_name(stretches_[s].d, stretches_[s].high != 0) +
          "_generator_length: the lumen changes along the inlet generator; accepted: a stretch with a constant lumen";
  PetscFunctionReturn(0);
}

// Normal velocities on the sides at the end of the step: those at the ends of the stretches, and what the flow rate
// lacks with the profile of the side.
PetscErrorCode InletGenerators::constrain(double dt) {
  const double time = flow_.now.time + dt;
  Field &velocity = flow_.velocity_star;
  PetscFunctionBeginUser;
  PetscCall(flow_.exchange.update_ghosts(velocity, Box::stencil_width));
  for (const Stretch &stretch : stretches_) {
    const int d = stretch.d, N = flow_.domain.domain_cells()[d];
    const int end = stretch.high ? N - stretch.cells : stretch.cells;
    BoundaryCondition &side = flow_.spec.sides[d][stretch.high];
    auto fed = std::make_shared<InletVelocity>();
    PetscCall(InletVelocity::copy(flow_.domain, velocity[d], d, end, stretch.line, fed.get()));
    ExactSums sums(1);
    double sum, cells = 1;
    for (int e = 0; e < 3; ++e) cells *= e == d ? 1 : flow_.domain.domain_cells()[e];
    const Int3 &n = flow_.domain.cells();
    const Split &split = flow_.domain.split();
    // One rank of the line adds, that which has the faces.
    const bool adds = split.position_along(d, end) == split.position_of(flow_.domain.rank())[d];
    fed->for_each([&](const Int3 &at, double &value) {
      bool own = adds;
      for (int e = 0; e < 3; ++e) own = own && (e == d || (at[e] >= 0 && at[e] < n[e]));
      if (own) sums.add(0, value);
    });
    PetscCall(sums.reduce(flow_.domain.comm(), &sum));
    const double missing = (stretch.high ? -1 : 1) * side.given.at(time) - sum / cells;
    fed->for_each([&](const Int3 &at, double &value) { value += missing * inflow_shape(flow_.domain, side, d, at); });
    side.fed = std::move(fed);
  }
  PetscFunctionReturn(0);
}

// The same from what is on the sides already.
PetscErrorCode InletGenerators::begin_resume() {
  const Field &velocity = flow_.now.velocity;
  PetscFunctionBeginUser;
  for (const Stretch &stretch : stretches_) {
    const int d = stretch.d;
    auto fed = std::make_shared<InletVelocity>();
    PetscCall(InletVelocity::copy(flow_.domain, velocity[d], d, stretch.high ? flow_.domain.domain_cells()[d] : 0,
                                  stretch.line, fed.get()));
    flow_.spec.sides[d][stretch.high].fed = std::move(fed);
  }
  PetscFunctionReturn(0);
}

// visit(stretch, label) for all cells of bodies in stretches, one after the other.
template <class Visit>
void InletGenerators::for_bodies(const Visit &visit) const {
  const std::vector<BodyInBox> boxed = boxed_.bodies().list();
  for (int s = 0; s < static_cast<int>(stretches_.size()); ++s) {
    for (const BodyInBox &body : boxed) {
      const ConstView phi = body.phase->fraction[0];
      bool any = false;
      for_cells(*body.box, stretches_[s],
                [&](int i, int j, int k) { any = any || phi(i, j, k) > BodyCells::threshold; });
      if (any) visit(s, body.number);
    }
    for (const Phase &phase : flow_.now.phases) {
      if (!phase.label || phase.material.is_rigid()) continue;
      const BodyCells cells{phase.label[0], phase.fraction[0]};
      for_cells(flow_.domain, stretches_[s], [&](int i, int j, int k) {
        if (const int label = static_cast<int>(cells(i, j, k)); label > 0) visit(s, label);
      });
    }
  }
}

PetscErrorCode InletGenerators::start() {
  std::map<int, int> here;
  PetscFunctionBeginUser;
  PetscCall(check_lumen());
  for_bodies([&](int stretch, int label) { here.try_emplace(label, stretch); });
  PetscCall(set_inside(here));
  PetscFunctionReturn(0);
}

PetscErrorCode InletGenerators::set_inside(const std::map<int, int> &here) {
  std::vector<int> all;
  PetscFunctionBeginUser;
  for (const auto &[label, stretch] : here) all.insert(all.end(), {label, stretch});
  PetscCall(gather_all(flow_.domain.comm(), &all));
  inside_.clear();
  for (std::size_t n = 0; n < all.size(); n += 2) {
    int &stretch = inside_.try_emplace(all[n], all[n + 1]).first->second;
    stretch = std::min(stretch, all[n + 1]);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode InletGenerators::find_passed(std::vector<int> *labels) const {
  std::vector<int> inside;
  PetscFunctionBeginUser;
  labels->clear();
  for (const auto &[label, stretch] : inside_) inside.push_back(label);
  std::vector<int> still(inside.size(), 0);
  for_bodies([&](int stretch, int label) {
    const auto at = std::lower_bound(inside.begin(), inside.end(), label);
    if (at != inside.end() && *at == label && inside_.at(label) == stretch) still[at - inside.begin()] = 1;
  });
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, still.data(), static_cast<int>(still.size()), MPI_INT, MPI_MAX, flow_.domain.comm()));
  for (std::size_t n = 0; n < inside.size(); ++n)
    if (still[n] == 0) labels->push_back(inside[n]);
  PetscFunctionReturn(0);
}

Int3 InletGenerators::shift_of(int label) const {
  const Stretch &stretch = stretches_[inside_.at(label)];
  Int3 shift{};
  shift[stretch.d] = stretch.high ? stretch.cells : -stretch.cells;
  return shift;
}

}  // namespace eulastic
