// Ghost updates by PETSc: a PetscSF whose roots are the values that a rank owns and whose leaves are ghosts, across
// periodic sides too. Who owns which ghost is read from the scatter of the DMDA.
//
// The components of a field travel in one message to each neighbour. Where x is not split, roots and leaves are whole
// rows, and the ghosts at their ends are the other end of the same row.
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

/// The layers of ghosts of a field to update. With `rows`, outside of whose spans the field holds its default, the ends
/// of rows that no span comes near are left alone, and if all spans are inside() ghost rows are, too. Without
/// `row_ends` rows are not wrapped around a periodic x: passes of several stages do that themselves (Sides::wrap).
struct WantedGhosts {
  Field *field;
  int width;
  const OccupiedRows *rows = nullptr;
  bool row_ends = true;
};

/// A ghost of this rank that copies a point, so that is not behind a side of the domain.
struct Ghost {
  Int3 at;                ///< local indices
  PetscInt owner;         ///< rank of the point that it copies
  PetscInt offset, size;  ///< of that point in a field of its owner; doubles per component there
};
/// All of them, as the scatter of the domain's DMDA says. Collective.
PetscErrorCode find_ghosts(const Domain &domain, std::vector<Ghost> *ghosts);

class GhostExchange {
public:
  explicit GhostExchange(const Domain &domain)
      : GhostExchange(domain, domain.comm(),
                      [&domain](std::vector<Ghost> *ghosts) { return find_ghosts(domain, ghosts); }) {}
  /// For boxes on the ranks of `comm`; `find` lists the ghosts of this rank when they are first needed.
  GhostExchange(const Box &box, MPI_Comm comm, std::function<PetscErrorCode(std::vector<Ghost> *)> find)
      : box_(&box), comm_(comm), find_(std::move(find)) {}

  /// Afterwards every ghost within `width` layers that is not behind a wall is right, on ranks that have cells. In
  /// ghost rows, ghosts behind walls of x and further out in x may have changed; all others are not touched.
  /// Collective.
  PetscErrorCode update_ghosts(Field &field, int width, const OccupiedRows *rows = nullptr);
  /// The same for several fields, whose messages are under way together, up to six components at a time.
  PetscErrorCode update_ghosts(const std::vector<WantedGhosts> &wanted);
  /// Its halves. Owned values must not change in between; updates of other fields may begin meanwhile.
  PetscErrorCode begin_update(const WantedGhosts &wanted);
  PetscErrorCode end_update(const WantedGhosts &wanted);

private:
  PetscErrorCode build_scatter(int width, int fields, PetscSF *sf);
  PetscErrorCode broadcast(const WantedGhosts &wanted,
                           PetscErrorCode (*bcast)(PetscSF, MPI_Datatype, const void *, void *, MPI_Op));
  void wrap_rows(const WantedGhosts &wanted) const;

  const Box *box_;
  MPI_Comm comm_;
  std::function<PetscErrorCode(std::vector<Ghost> *)> find_;
  std::optional<std::vector<Ghost>> ghosts_;
  MpiType unit_;  ///< of roots and leaves: a row, its ghosts and padding included, or a value
  std::map<std::pair<int, int>, SfHandle> scatters_;  ///< by width and number of fields
};

}  // namespace eulastic
