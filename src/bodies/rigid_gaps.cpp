// RigidBodies: the volume between the surface of bodies that rest and the faces inside them.
#include "base/exact_sum.hpp"
#include "bodies/rigid.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

// Every cell gives half of its solid fraction to each of its two faces of a component. A fluid face has it in excess of
// what counts as inside; a face inside lacks what the cell has of fluid. Where bodies overlap only one of them counts.
PetscErrorCode RigidBodies::measure_gaps(const std::vector<Phase> &phases) {
  PetscFunctionBeginUser;
  if (!exist()) PetscFunctionReturn(0);
  constexpr int per_component = 4, per_body = 3 * per_component;
  const int dimension = domain_.dimension(), cells = domain_.cells()[0];
  ExactSums sums(per_body * faces_.count);
  faces_.footprints.clear();
  const auto add = [&](int image, int a, const Int3 &cell, int high, double part, bool nearest) {
    const int index = faces_.bodies[image].index, side = domain_.layout().begin[a] + cell[a] + high;
    Int3 face = cell;
    face[a] += high;
    const Real3 place = place_of_face(domain_, a, face[0], face[1], face[2]);
    if (domain_.is_wall(a) && (side == 0 || side == domain_.domain_cells()[a]))
      faces_.footprints.push_back({cell, a, high > 0, image, 2 * part});
    const PlacedBody *body = sources_[index].body.get();
    const Real3 &centre = faces_.bodies[image].centre;
    sums.add(per_body * index + per_component * a, part);
    for (int d = 0; d < dimension; ++d) {
      double arm = place[d] - centre[d];
      if (nearest && body && body->ends(d) && !domain_.is_wall(d))
        arm -= domain_.domain_cells()[d] * std::round(arm / domain_.domain_cells()[d]);
      sums.add(per_body * index + per_component * a + 1 + d, part * arm * domain_.spacing()[d]);
    }
  };
  const auto rests = [&](const Phase &phase) { return phase.material.is_rigid() && !travels(phase); };
  const auto index_of = [&](const Phase &phase, int label) {
    for (std::size_t index = 0; index < sources_.size(); ++index) {
      const Species &species = species_[faces_.bodies[images * index].motion];
      if (species.spec.name != phase.species) continue;
      return static_cast<int>(index) + label - species.first_label;  // bodies of a species follow each other
    }
    return -1;
  };
  std::array<std::vector<int>, 2> beside{std::vector<int>(cells), std::vector<int>(cells)};
  for (const Segment &row : domain_.rows())
    for (int a = 0; a < dimension; ++a) {
      for (const int high : {0, 1}) {
        faces_.find_beside(a, high > 0, row.j, row.k, &beside[high]);
        for (int &image : beside[high])
          if (image >= 0 && faces_.motions[faces_.bodies[image].motion].travels()) image = -1;
      }
      for (int i = 0; i < cells; ++i) {
        double solid = 0;
        for (const Phase &phase : phases)
          if (rests(phase)) solid += phase.fraction[0](i, row.j, row.k);
        const double fluid = 1 - std::min(1.0, solid);
        if (solid == 0 && beside[0][i] < 0 && beside[1][i] < 0) continue;
        for (const int high : {0, 1}) {
          const Int3 cell{i, row.j, row.k};
          if (beside[high][i] >= 0) {
            if (fluid > 0) add(beside[high][i], a, cell, high, -0.5 * fluid, false);
            continue;
          }
          for (const Phase &phase : phases) {
            const double part = rests(phase) ? phase.fraction[0](i, row.j, row.k) : 0;
            const int index = part > 0 && phase.label ? index_of(phase, int(phase.label[0](i, row.j, row.k))) : -1;
            if (index >= 0 && index < faces_.count)
              add(image_of(index, {0, 0, 0}), a, cell, high, 0.5 * part * std::min(1.0, 1 / solid), true);
          }
        }
      }
    }
  std::vector<double> total(per_body * faces_.count);
  PetscCall(sums.reduce(domain_.comm(), total.data()));
  faces_.gaps.assign(faces_.count, {});
  for (int index = 0; index < faces_.count; ++index)
    for (int a = 0; a < 3; ++a) {
      const double *found = &total[per_body * index + per_component * a];
      faces_.gaps[index].volume[a] = found[0] * domain_.cell_volume();
      for (int d = 0; d < 3; ++d) faces_.gaps[index].first[a][d] = found[1 + d] * domain_.cell_volume();
    }
  PetscCall(measure_pistons());
  PetscFunctionReturn(0);
}

}  // namespace eulastic
