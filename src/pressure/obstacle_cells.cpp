// ObstacleSolver: what the pressure and its update are in cells beside bodies, or within them.
#include "base/events.hpp"
#include "field/open_sides.hpp"
#include "pressure/obstacles.hpp"

#include <algorithm>
#include <numeric>

namespace eulastic {
namespace {

constexpr double least_open = 0.03;  // that D* is divided by

}  // namespace

PetscErrorCode ObstacleSolver::extend(Field &pressure) const {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::rigid);
  WorkSpace::Lease taken;
  PetscCall(work_->take("known pressure", 2, &taken));
  Field known = taken.part(0, 1), next = taken.part(1, 1);
  for (Field *block : {&known, &next}) block->fill(0, 1);
  for_closed_cells(
      [&](const Int3 &cell) { known[0](cell[0], cell[1], cell[2]) = next[0](cell[0], cell[1], cell[2]) = 0; });
  PetscCall(extend_layer(known, next, pressure));
  PetscCall(extend_layer(next, known, pressure));
  PetscFunctionReturn(0);
}

PetscErrorCode ObstacleSolver::extend_layer(Field &known, Field &next, Field &pressure) const {
  PetscFunctionBeginUser;
  PetscCall(exchange_->update_ghosts(known, 1));
  PetscCall(exchange_->update_ghosts(pressure, 1));
  std::size_t at = 0;
  const View p = pressure[0];
  for (const Segment &row : domain_->rows()) {
    for (std::size_t c = first_[at]; c < first_[at + 1]; ++c) {
      const Int3 cell{cells_[c].i, row.j, row.k};
      const double *is_known = &known[0](cell[0], cell[1], cell[2]);
      double *value = &p(cell[0], cell[1], cell[2]);
      if (*is_known != 0) continue;
      double sum = 0, count = 0;
      for (int d = 0; d < domain_->dimension(); ++d) {
        double pair[2] = {};
        for (int high = 0; high < 2; ++high) {
          const std::ptrdiff_t step = high ? p.stride(d) : -p.stride(d);
          const int global = domain_->layout().begin[d] + cell[d] + (high ? 1 : -1);
          if ((domain_->is_wall(d) && (global < 0 || global >= domain_->domain_cells()[d])) || is_known[step] == 0)
            continue;
          pair[high] = value[step];
          ++count;
        }
        sum += pair[0] + pair[1];
      }
      if (count == 0) continue;
      *value = sum / count;
      next[0](cell[0], cell[1], cell[2]) = 1;
    }
    ++at;
  }
  PetscFunctionReturn(0);
}

void ObstacleSolver::copy_closed(const Field &from, Field *to) const {
  for_closed_cells([&](const Int3 &cell) { (*to)[0](cell[0], cell[1], cell[2]) = from[0](cell[0], cell[1], cell[2]); });
}

PetscErrorCode ObstacleSolver::spread(double part, Field &divergence) const {
  PetscFunctionBeginUser;
  const int faces = 2 * domain_->dimension();
  std::size_t at = 0;
  for (const Segment &row : domain_->rows()) {
    double *D = divergence[0].row(row.j, row.k);
    for (std::size_t c = first_[at]; c < first_[at + 1]; ++c) {
      const double open = std::accumulate(cells_[c].open, cells_[c].open + faces, 0.0) / faces;
      D[cells_[c].i] /= std::max({least_open, open, part * cells_[c].response});
    }
    ++at;
  }
  PetscCall(exchange_->update_ghosts(divergence, 1));
  fill_ghosts_of_increment(*domain_, divergence[0], 1);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
