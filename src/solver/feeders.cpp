#include "solver/feeders.hpp"

#include "bodies/near_bodies.hpp"
#include "field/exact_sum.hpp"
#include "field/fed_velocity.hpp"
#include "field/open_sides.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace eulastic {

bool Feeders::exist(const BoxSides &sides) {
  return std::any_of(sides.begin(), sides.end(), [](const auto &pair) { return pair[0].feeder || pair[1].feeder; });
}

Feeders::~Feeders() {
  for (Stretch &stretch : stretches_) (void)MPI_Comm_free(&stretch.line);
}

PetscErrorCode Feeders::create(const Grid &grid, const BoxSides &sides) {
  PetscFunctionBeginUser;
  grid_ = &grid;
  const Int3 place = grid.place_of(grid.rank());
  for (int d = 0; d < grid.dimension(); ++d)
    for (const int high : {0, 1}) {
      if (sides[d][high].feeder == 0) continue;
      Int3 first = place;
      first[d] = 0;
      MPI_Comm line;
      PetscCallMPI(MPI_Comm_split(grid.comm(), grid.rank_at(first), place[d], &line));
      stretches_.push_back({d, high, sides[d][high].feeder, line});
    }
  PetscFunctionReturn(0);
}

template <class Visit>
void Feeders::for_cells(const Stretch &stretch, const Visit &visit) const {
  const int d = stretch.d, deep = stretch.cells + beyond, begin = grid_->layout().begin[d];
  Int3 from{}, to = grid_->owned();
  if (stretch.high)
    from[d] = std::max(0, grid_->cells()[d] - deep - begin);
  else
    to[d] = std::min(to[d], deep - begin);
  for (int k = from[2]; k < to[2]; ++k)
    for (int j = from[1]; j < to[1]; ++j)
      for (int i = from[0]; i < to[0]; ++i) visit(i, j, k);
}

PetscErrorCode Feeders::check_lumen(const std::vector<Phase> &phases, std::string *wrong) const {
  constexpr double same = 0.05;  // of a solid fraction; surfaces of triangles and voxels are not quite straight
  std::vector<double> change(stretches_.size(), 0);
  PetscFunctionBeginUser;
  for (std::size_t s = 0; s < stretches_.size(); ++s)
    for (const Phase &phase : phases) {
      if (!phase.material.is_rigid()) continue;
      const ConstView phi = phase.fraction[0];
      const std::ptrdiff_t next = (stretches_[s].high ? -1 : 1) * phi.stride(stretches_[s].d);
      for_cells(stretches_[s], [&](int i, int j, int k) {
        const double *here = &phi(i, j, k);
        change[s] = std::max(change[s], std::fabs(here[next] - here[0]));
      });
    }
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, change.data(), static_cast<int>(change.size()), MPI_DOUBLE, MPI_MAX, grid_->comm()));
  for (std::size_t s = 0; s < stretches_.size(); ++s)
    if (change[s] > same)
      *wrong = std::string("-inflow_") + "xyz"[stretches_[s].d] + (stretches_[s].high ? "max" : "min") +
               "_feeder: rigid bodies change along it; accepted: a stretch along which the lumen is the same";
  PetscFunctionReturn(0);
}

PetscErrorCode Feeders::feed_velocity(double time, const FieldBlock &velocity, BoxSides *sides) const {
  PetscFunctionBeginUser;
  for (const Stretch &stretch : stretches_) {
    const int d = stretch.d, N = grid_->cells()[d];
    const int end = stretch.high ? N - stretch.cells : stretch.cells;
    Side &side = (*sides)[d][stretch.high];
    auto fed = std::make_shared<FedVelocity>();
    PetscCall(FedVelocity::copy(*grid_, velocity[d], d, end, stretch.line, fed.get()));
    ExactSums sums(1);
    double sum, cells = 1;
    for (int e = 0; e < 3; ++e) cells *= e == d ? 1 : grid_->cells()[e];
    const Int3 &n = grid_->owned();
    // One rank of the line adds, that which has the faces.
    const bool adds = grid_->owner_along(d, end) == grid_->place_of(grid_->rank())[d];
    fed->for_each([&](const Int3 &at, double &value) {
      bool own = adds;
      for (int e = 0; e < 3; ++e) own = own && (e == d || (at[e] >= 0 && at[e] < n[e]));
      if (own) sums.add(0, value);
    });
    PetscCall(sums.reduce(grid_->comm(), &sum));
    const double missing = (stretch.high ? -1 : 1) * side.given.at(time) - sum / cells;
    fed->for_each([&](const Int3 &at, double &value) { value += missing * inflow_shape(*grid_, side, d, at); });
    side.fed = std::move(fed);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode Feeders::recall_velocity(const FieldBlock &velocity, BoxSides *sides) const {
  PetscFunctionBeginUser;
  for (const Stretch &stretch : stretches_) {
    const int d = stretch.d;
    auto fed = std::make_shared<FedVelocity>();
    PetscCall(FedVelocity::copy(*grid_, velocity[d], d, stretch.high ? grid_->cells()[d] : 0, stretch.line, fed.get()));
    (*sides)[d][stretch.high].fed = std::move(fed);
  }
  PetscFunctionReturn(0);
}

// Of each of these bodies, ascending, a bit for each stretch that has a cell of it.
PetscErrorCode Feeders::find_bodies(const std::vector<Phase> &phases, const std::vector<int> &labels,
                                    std::vector<unsigned> *where) const {
  PetscFunctionBeginUser;
  where->assign(labels.size(), 0);
  for (std::size_t s = 0; s < stretches_.size(); ++s)
    for (const Phase &phase : phases) {
      if (!phase.label || phase.material.is_rigid()) continue;
      const BodyCells cells{phase.label[0], phase.fraction[0]};
      for_cells(stretches_[s], [&](int i, int j, int k) {
        const int label = static_cast<int>(cells(i, j, k));
        const auto at = std::lower_bound(labels.begin(), labels.end(), label);
        if (at != labels.end() && *at == label) (*where)[at - labels.begin()] |= 1U << s;
      });
    }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, where->data(), static_cast<int>(where->size()), MPI_UNSIGNED, MPI_BOR,
                             grid_->comm()));
  PetscFunctionReturn(0);
}

PetscErrorCode Feeders::start(const std::vector<Phase> &phases, int bodies) {
  std::vector<unsigned> where;
  std::vector<int> all(bodies);
  PetscFunctionBeginUser;
  std::iota(all.begin(), all.end(), 1);
  PetscCall(find_bodies(phases, all, &where));
  inside_.assign(bodies, 0);
  for (int b = 0; b < bodies; ++b)
    for (int s = static_cast<int>(stretches_.size()) - 1; s >= 0; --s)
      if (where[b] >> s & 1U) inside_[b] = s + 1;
  PetscFunctionReturn(0);
}

PetscErrorCode Feeders::find_passed(const std::vector<Phase> &phases, std::vector<int> *labels) const {
  std::vector<unsigned> where;
  std::vector<int> inside;
  PetscFunctionBeginUser;
  labels->clear();
  for (std::size_t b = 0; b < inside_.size(); ++b)
    if (inside_[b] > 0) inside.push_back(static_cast<int>(b) + 1);
  PetscCall(find_bodies(phases, inside, &where));
  for (std::size_t n = 0; n < inside.size(); ++n)
    if (!(where[n] >> (inside_[inside[n] - 1] - 1) & 1U)) labels->push_back(inside[n]);
  PetscFunctionReturn(0);
}

Int3 Feeders::shift_of(int label) const {
  const Stretch &stretch = stretches_[inside_[label - 1] - 1];
  Int3 shift{};
  shift[stretch.d] = stretch.high ? stretch.cells : -stretch.cells;
  return shift;
}

}  // namespace eulastic
