// Adhesion: measures of its bonds.
#include "adhesion/adhesion.hpp"
#include "adhesion/grid_place.hpp"
#include "base/body_range.hpp"
#include "base/exact_sum.hpp"
#include "base/send_to_ranks.hpp"

#include <algorithm>
#include <utility>

namespace eulastic {

PetscErrorCode Adhesion::sum_events() {
  std::int64_t here[2] = {std::exchange(formed_here_, 0), std::exchange(lost_here_, 0)};
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, here, 2, MPI_INT64_T, MPI_SUM, flow_.domain.comm()));
  formed_ += here[0];
  lost_ += here[1];
  PetscFunctionReturn(0);
}

PetscErrorCode Adhesion::measure(BondTotals *totals) {
  ExactSums sums(4);
  double found[4];
  PetscFunctionBeginUser;
  PetscCall(sum_events());
  for (const Bond &bond : bonds_) {
    const double partner = bodies()[bond.body].receptors[bond.receptor].partner;
    sums.add(0, partner == Receptor::wall ? 1 : 0.5);  // both ends of other bonds are counted
    for (int d = 0; d < 3; ++d) sums.add(1 + d, bond.pull[d]);
  }
  PetscCall(sums.reduce(flow_.domain.comm(), found));
  *totals = {found[0], double(formed_), double(lost_), {found[1], found[2], found[3]}};
  PetscFunctionReturn(0);
}

// Sets the body on whose surface the anchor lies, on the rank that owns its cell; 0 if it is not known.
void Adhesion::find_body(End *end) const {
  const Domain &domain = flow_.domain;
  const Phase &phase = flow_.now.phases[spec_.pairs[end->pair].second];
  const Int3 &cell = GridPlace(domain, end->anchor).cell, &begin = domain.layout().begin;
  end->body =
      phase.label ? static_cast<int>(phase.label[0](cell[0] - begin[0], cell[1] - begin[1], cell[2] - begin[2])) : 0;
}

// Lists the ends of bonds on bodies in boxes and on surfaces on the grid.
PetscErrorCode Adhesion::find_ends(std::vector<End> *ends) const {
  const Domain &domain = flow_.domain;
  std::vector<End> on_surfaces;
  std::vector<int> to;
  PetscFunctionBeginUser;
  ends->clear();
  for (const Bond &bond : bonds_) {
    const Receptor &receptor = bodies()[bond.body].receptors[bond.receptor];
    const ReceptorName name = name_of(bond.body, bond.receptor);
    const int pair = static_cast<int>(receptor.pair);
    End end{name.body, pair, name, receptor.anchor, bond.pull, bond.tension, flow_.now.time - receptor.since};
    ends->push_back(end);
    if (!is_on_grid(spec_.pairs[pair])) continue;
    for (double &force : end.force) force = -force;
    on_surfaces.push_back(end);
    to.push_back(GridPlace(domain, end.anchor).owner(domain));
  }
  PetscCall(send_to_ranks(domain.comm(), to, &on_surfaces));
  for (End &end : on_surfaces) {
    find_body(&end);
    if (end.body > 0) ends->push_back(end);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode Adhesion::measure(int bodies, std::vector<BodyBonds> *owned) const {
  const Domain &domain = flow_.domain;
  const BodyRange range = BodyRange::of(bodies, domain.rank(), domain.ranks());
  std::vector<End> ends;
  std::vector<int> to;
  PetscFunctionBeginUser;
  PetscCall(find_ends(&ends));
  for (const End &end : ends) to.push_back(BodyRange::owner(end.body - 1, bodies, domain.ranks()));
  PetscCall(send_to_ranks(domain.comm(), to, &ends));
  std::sort(ends.begin(), ends.end(), [](const End &one, const End &other) { return one.receptor < other.receptor; });
  owned->assign(range.size(), {});
  for (const End &end : ends) {
    BodyBonds &body = (*owned)[end.body - 1 - range.begin];
    body.body = end.body;
    ++body.bonds;
    for (int d = 0; d < 3; ++d) body.force[d] += end.force[d];
    body.tension += end.tension;
    body.age += end.age;
  }
  for (BodyBonds &body : *owned) {
    body.tension /= std::max(body.bonds, 1);
    body.age /= std::max(body.bonds, 1);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode Adhesion::lines(std::vector<BondLine> *lines) const {
  PetscFunctionBeginUser;
  lines->clear();
  for (const Bond &bond : bonds_) {
    const Receptor &receptor = bodies()[bond.body].receptors[bond.receptor];
    const ReceptorName name = name_of(bond.body, bond.receptor);
    const ReceptorName partner{static_cast<int>(receptor.partner), static_cast<int>(receptor.other)};
    if (partner.body > 0 && partner < name) continue;
    lines->push_back({name, partner, receptor.place, receptor.anchor, bond.tension, receptor.since});
  }
  PetscCall(send_to_ranks(flow_.domain.comm(), std::vector<int>(lines->size(), 0), lines));
  std::sort(lines->begin(), lines->end(),
            [](const BondLine &one, const BondLine &other) { return one.receptor < other.receptor; });
  PetscFunctionReturn(0);
}

PetscErrorCode Adhesion::take_events(std::vector<BondEvent> *events) {
  PetscFunctionBeginUser;
  *events = std::exchange(events_, {});
  PetscCall(send_to_ranks(flow_.domain.comm(), std::vector<int>(events->size(), 0), events));
  std::sort(events->begin(), events->end(), [](const BondEvent &one, const BondEvent &other) {
    return std::tie(one.time, one.formed, one.receptor) < std::tie(other.time, other.formed, other.receptor);
  });
  PetscFunctionReturn(0);
}

}  // namespace eulastic
