// Ghost-only exchange: a PetscSF straight on the local arrays, so that no interior value is ever copied.
//
// Ghosts in a periodic direction that is not split are copied row by row, in x within the row, and never enter the SF.
// Index N of a wall direction (the high wall of staggered fields) counts as owned: its values travel like any others.
// In large boxes whole rows go in runs of up to eight values, a line of the cache, so that the tables of the SF are
// that much smaller.
#pragma once

#include "field/field_block.hpp"
#include "grid/occupied_rows.hpp"

#include <map>

namespace eulastic {

class GhostExchange {
public:
  explicit GhostExchange(const Grid &grid) : grid_(&grid) {}

  /// Starts filling `width` ghost layers of every field of `block`. One exchange per block at a time; several
  /// blocks may be under way together.
  /// Where `rows` is given and all lies inside(), ghosts are taken to be valid already.
  PetscErrorCode begin(FieldBlock &block, int width, const OccupiedRows *rows = nullptr);
  /// Completes it: ghosts inside the domain and across periodic sides are valid, those behind walls are not. In idle
  /// rows of `rows`, where it is given, what lies across a periodic x is taken to be valid already.
  PetscErrorCode end(FieldBlock &block, int width, const OccupiedRows *rows = nullptr);
  /// Both.
  PetscErrorCode update(FieldBlock &block, int width, const OccupiedRows *rows = nullptr);
  /// Both, where whoever wrote the owned rows has wrapped them around a periodic x (Grid::wrap_row).
  PetscErrorCode update_wrapped(FieldBlock &block, int width, const OccupiedRows *rows = nullptr);
  /// Both, but for what lies across a periodic x that is not split.
  PetscErrorCode update_rows(FieldBlock &block, int width);
  /// That of two blocks, whose messages are under way together.
  PetscErrorCode update_rows(FieldBlock &first, int first_width, FieldBlock &second, int second_width);

private:
  struct Key {
    int fields, width;
    bool operator<(const Key &other) const {
      return fields != other.fields ? fields < other.fields : width < other.width;
    }
  };
  /// Consecutive values that travel as one, and their type where they are several.
  struct Run {
    int length = 0;  ///< 0: not made yet
    MPI_Datatype type = MPI_DATATYPE_NULL;
    Run() = default;
    Run(const Run &) = delete;
    Run &operator=(const Run &) = delete;
    ~Run() {
      if (length > 1) (void)MPI_Type_free(&type);
    }
  };
  PetscErrorCode make_run();
  PetscErrorCode forest(const Key &key, PetscSF *sf);
  PetscErrorCode end_rows(FieldBlock &block, int width, const OccupiedRows *rows);
  struct Range {
    int begin, end;
  };
  Range reach(int d, int width) const;
  bool is_copied(int d) const;
  void copy_rows(FieldBlock &block, int width) const;
  template <class Skip>
  void wrap_rows(FieldBlock &block, int width, Skip skip) const;

  const Grid *grid_;
  Run run_;
  std::map<Key, SfHandle> forests_;
};

}  // namespace eulastic
