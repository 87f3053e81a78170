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
#include <memory>
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

/// All ghosts of this rank that copy a point, so those that are not behind sides of the domain.
struct GhostList {
  struct Ghost {
    Int3 at;               ///< local indices
    int owner;             ///< rank of the point that it copies
    std::ptrdiff_t there;  ///< offset of that point in a field of its owner
  };
  std::vector<Ghost> ghosts;
  std::map<int, std::ptrdiff_t> field_size;  ///< doubles per field of each owner

  /// Reads them from the scatter of the domain's DMDA. Collective.
  PetscErrorCode read(const Domain &domain);
};

class GhostExchange {
public:
  explicit GhostExchange(const Domain &domain)
      : GhostExchange(domain, domain.comm(), [&domain](GhostList *list) { return list->read(domain); }) {}
  /// For boxes on the ranks of `comm`; `find` lists the ghosts of this rank and is called when they are first needed.
  GhostExchange(const Box &box, MPI_Comm comm, std::function<PetscErrorCode(GhostList *)> find)
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
  /// What roots and leaves are: a row, its ghosts and padding included, or a value.
  struct Unit {
    MPI_Datatype type = MPI_DATATYPE_NULL;
    Unit() = default;
    PetscErrorCode make(std::ptrdiff_t values);
    Unit(const Unit &) = delete;
    Unit &operator=(const Unit &) = delete;
    ~Unit() {
      if (type != MPI_DATATYPE_NULL) (void)MPI_Type_free(&type);
    }
  };
  PetscErrorCode build_scatter(int width, int fields, PetscSF *sf);
  PetscErrorCode broadcast(const WantedGhosts &wanted,
                           PetscErrorCode (*bcast)(PetscSF, MPI_Datatype, const void *, void *, MPI_Op));
  void wrap_rows(const WantedGhosts &wanted) const;

  const Box *box_;
  MPI_Comm comm_;
  std::function<PetscErrorCode(GhostList *)> find_;
  std::unique_ptr<GhostList> list_;  ///< null until it is needed
  Unit unit_;
  std::map<std::pair<int, int>, SfHandle> scatters_;  ///< by width and number of fields
};

}  // namespace eulastic
