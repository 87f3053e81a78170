#include "openings/body_copy.hpp"

#include "base/send_to_ranks.hpp"
#include "bodies/labels.hpp"
#include "field/boundaries.hpp"

#include <algorithm>

namespace eulastic {
namespace {

constexpr int margin = 2;  // cells around a membrane where its tensor may evolve

// visit(component, offset of a point) for all points of B that a cell touches.
template <class Visit>
void for_each_point(const CarriedTensor &tensor, const Visit &visit) {
  for (int c = 0; c < tensor.field.count(); ++c) {
    const TensorComponent &component = tensor.components()[c];
    for (int corner = 0; corner < (component.on_edge() ? 4 : 1); ++corner) {
      Int3 offset{};
      offset[component.a] += corner & 1;
      offset[component.b] += corner >> 1;
      visit(c, offset);
    }
  }
}

// Of an owned cell: its own label, or of a membrane that of one nearby.
int whose(const Phase &phase, int dimension, const Int3 &c, const std::vector<int> &labels) {
  const BodyCells cells{phase.label[0], phase.fraction[0]};
  const auto wanted = [&](double label) {
    return label > 0 && std::find(labels.begin(), labels.end(), static_cast<int>(label)) != labels.end();
  };
  const double own = cells(c[0], c[1], c[2]);
  if (wanted(own)) return static_cast<int>(own);
  if (own > 0 || !phase.material.is_membrane()) return 0;
  const int deep = dimension == 3 ? margin : 0;
  for (int k = c[2] - deep; k <= c[2] + deep; ++k)
    for (int j = c[1] - margin; j <= c[1] + margin; ++j)
      for (int i = c[0] - margin; i <= c[0] + margin; ++i)
        if (wanted(cells(i, j, k))) return static_cast<int>(cells(i, j, k));
  return 0;
}

template <class Visit>
void for_owned_cells(const Box &box, const BodyCopy &body, const Int3 &shift, const Visit &visit) {
  const Int3 &begin = box.layout().begin, &n = box.cells();
  for (const BodyCopy::Cell &cell : body.cells) {
    Int3 local;
    bool own = true;
    for (int d = 0; d < 3; ++d) {
      local[d] = box.image(d, cell.at[d] + shift[d]) - begin[d];
      own = own && local[d] >= 0 && local[d] < n[d];
    }
    if (own) visit(cell, local);
  }
}

}  // namespace

PetscErrorCode copy_bodies(const Domain &domain, GhostExchange &exchange, const std::vector<int> &labels,
                           std::vector<Phase> *phases, std::vector<BodyCopy> *bodies) {
  const int dimension = domain.dimension();
  constexpr int head = 6, width = head + BodyCopy::points;  // label, phase, place, phi, B
  const Int3 &begin = domain.layout().begin;
  std::vector<double> all;
  PetscFunctionBeginUser;
  for (std::size_t p = 0; p < phases->size(); ++p) {
    Phase &phase = (*phases)[p];
    if (!phase.label || phase.material.is_rigid()) continue;
    if (phase.material.is_membrane()) {
      PetscCall(exchange.update_ghosts({{&phase.label, margin, &phase.rows}, {&phase.fraction, margin, &phase.rows}}));
    }
    for_points(domain.rows(), [&](int i, int j, int k) {
      const Int3 at{i, j, k};
      const int label = whose(phase, dimension, at, labels);
      if (label == 0) return;
      const BodyCells cells{phase.label[0], phase.fraction[0]};
      all.insert(all.end(), {double(label), double(p), double(begin[0] + i), double(begin[1] + j), double(begin[2] + k),
                             cells(i, j, k) > 0 ? phase.fraction[0](i, j, k) : -1});
      const std::size_t end = all.size() + BodyCopy::points;
      for_each_point(phase.tensor,
                     [&](int c, const Int3 &o) { all.push_back(phase.tensor.field[c](i + o[0], j + o[1], k + o[2])); });
      all.resize(end, 0);
    });
  }
  PetscCall(gather_all(domain.comm(), &all));
  bodies->assign(labels.size(), {});
  for (std::size_t b = 0; b < labels.size(); ++b) (*bodies)[b].label = labels[b];
  for (const double *v = all.data(); v < all.data() + all.size(); v += width) {
    const auto found = std::find(labels.begin(), labels.end(), static_cast<int>(v[0]));
    BodyCopy &body = (*bodies)[found - labels.begin()];
    body.phase = static_cast<int>(v[1]);
    BodyCopy::Cell cell{{static_cast<int>(v[2]), static_cast<int>(v[3]), static_cast<int>(v[4])}, v[5], {}};
    std::copy_n(v + head, BodyCopy::points, cell.B.begin());
    body.cells.push_back(cell);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode find_fullest(const Domain &domain, const BodyCopy &body, const Int3 &shift, ConstView filled,
                            double *fullest) {
  PetscFunctionBeginUser;
  *fullest = 0;
  for_owned_cells(domain, body, shift, [&](const BodyCopy::Cell &cell, const Int3 &at) {
    if (cell.phi > 0) *fullest = std::max(*fullest, cell.phi + filled(at[0], at[1], at[2]));
  });
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, fullest, 1, MPI_DOUBLE, MPI_MAX, domain.comm()));
  PetscFunctionReturn(0);
}

void insert_body(const Box &box, const BodyCopy &body, const Int3 &shift, int label, Phase *phase) {
  const Int3 &begin = box.layout().begin;
  for_owned_cells(box, body, shift, [&](const BodyCopy::Cell &cell, const Int3 &at) {
    if (!(cell.phi > 0)) return;
    phase->fraction[0](at[0], at[1], at[2]) = cell.phi;
    phase->label[0](at[0], at[1], at[2]) = label;
  });
  if (!phase->material.carries_tensor()) return;
  for (const BodyCopy::Cell &cell : body.cells) {
    int point = 0;
    for_each_point(phase->tensor, [&](int c, const Int3 &offset) {
      const Staggering &staggered = phase->tensor.components()[c].at;
      const double value = cell.B[point++];
      Int3 at;
      for (int d = 0; d < 3; ++d) {
        at[d] = box.image(d, cell.at[d] + shift[d] + offset[d]) - begin[d];
        if (at[d] < 0 || at[d] >= box.points_end(d, staggered[d])) return;
      }
      phase->tensor.field[c](at[0], at[1], at[2]) = value;
    });
  }
}

}  // namespace eulastic
