// Ghost updates by PETSc: a PetscSF whose roots are the values that a rank owns and whose leaves are ghosts, including
// those across periodic boundaries. The owners of ghosts are read from the scatter of the DMDA.
//
// All components of a field are sent in one message to each neighbour. Where x is not split, roots and leaves are whole
// rows, and the ghosts at the ends of a row are copied from its other end.
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"
#include "grid/domain.hpp"
#include "grid/occupied_rows.hpp"

#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace eulastic {

/// The ghost layers of a field to update. With `rows`, outside of whose spans the field holds its default, row ends far
/// from any span are skipped, and ghost rows as well if all spans are inside(). Without `row_ends` the ends of rows of
/// a periodic x are not filled: fused stages do that themselves (HaloOverlap::wrap).
struct GhostUpdate {
  Field *field;
  int width;
  const OccupiedRows *rows = nullptr;
  bool row_ends = true;
};

/// A ghost of this rank that is not behind a boundary of the domain, and the point that it copies.
struct Ghost {
  Int3 at;                ///< local indices
  PetscInt owner;         ///< rank of the copied point
  PetscInt offset, size;  ///< offset of that point in a field of its owner; doubles per component there
};
/// Lists all ghosts of this rank from the scatter of the domain's DMDA. Collective.
PetscErrorCode find_ghosts(const Domain &domain, std::vector<Ghost> *ghosts);

/// Updates ghosts of fields on a domain or in boxes. A scatter is built for each width and number of components.
class GhostExchange {
public:
  explicit GhostExchange(const Domain &domain)
      : GhostExchange(domain, domain.comm(),
                      [&domain](std::vector<Ghost> *ghosts) { return find_ghosts(domain, ghosts); }) {}
  /// For boxes on the ranks of `comm`. `find` lists the ghosts of this rank; it is called at the first update.
  GhostExchange(const Box &box, MPI_Comm comm, std::function<PetscErrorCode(std::vector<Ghost> *)> find)
      : box_(&box), comm_(comm), find_(std::move(find)) {}
  /// The communicator of the ranks that share the ghosts.
  MPI_Comm comm() const { return comm_; }

  /// Updates every ghost within `width` layers that is not behind a boundary, on ranks that have cells. In ghost rows,
  /// ghosts behind boundaries in x and those beyond `width` in x may change; no other values do. Collective.
  PetscErrorCode update_ghosts(Field &field, int width, const OccupiedRows *rows = nullptr);
  /// Updates several fields with overlapping messages, up to six components at a time. Collective.
  PetscErrorCode update_ghosts(const std::vector<GhostUpdate> &wanted);
  /// The two halves of update_ghosts(). Owned values must not change in between; updates of other fields may begin.
  PetscErrorCode begin_update(const GhostUpdate &wanted);
  PetscErrorCode end_update(const GhostUpdate &wanted);

private:
  PetscErrorCode build_scatter(int width, int fields, PetscSF *sf);
  PetscErrorCode broadcast(const GhostUpdate &wanted,
                           PetscErrorCode (*bcast)(PetscSF, MPI_Datatype, const void *, void *, MPI_Op));
  void wrap_rows(const GhostUpdate &wanted) const;

  const Box *box_;
  MPI_Comm comm_;
  std::function<PetscErrorCode(std::vector<Ghost> *)> find_;
  std::optional<std::vector<Ghost>> ghosts_;
  MpiType unit_;  ///< of roots and leaves: a row with its ghosts and padding, or a value
  std::map<std::pair<int, int>, SfHandle> scatters_;  ///< by width and number of components
};

}  // namespace eulastic
