// Ghost-only exchange on the local arrays: no interior value is ever copied but into messages.
//
// What two ranks exchange are boxes, with all fields of a block. A box goes in one message, or, where it consists of
// large pieces of planes, these go one by one as they are, with what lies between their rows. Ghosts in a periodic
// direction that is not split are copied row by row, in x within the row, and are in no message. Index N of a wall
// direction (the high wall of staggered fields) counts as owned: its values travel like any others.
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
  /// Completes it: ghosts inside the domain and across periodic sides are valid, those behind walls are not, and at the
  /// ends of ghost rows those further out than `width` may have changed. In idle rows of `rows`, where it is given,
  /// what lies across a periodic x is taken to be valid already.
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
  struct Box {
    Int3 begin, end;
    std::size_t points() const;
  };
  struct Message {
    int rank;  ///< whom it goes to or comes from
    Box box;
    int piece;  ///< values of a plane that go as they are, with what lies between rows; 0: they are copied
  };
  /// Of one width, the same for every block.
  struct Plan {
    std::vector<Message> sent, received;
  };
  /// Of one block, from begin() to end().
  struct UnderWay {
    const double *block = nullptr;  ///< null: free
    std::vector<double> sent, received;
    std::vector<MPI_Request> requests;
  };
  /// Of its own, so that nobody else's messages can be taken for them.
  struct Comm {
    MPI_Comm comm = MPI_COMM_NULL;
    Comm() = default;
    Comm(const Comm &) = delete;
    Comm &operator=(const Comm &) = delete;
    ~Comm() {
      if (comm != MPI_COMM_NULL) (void)MPI_Comm_free(&comm);
    }
  };
  struct Stretch;
  std::vector<Stretch> stretches(int d, int place, int width) const;
  const Plan &plan(int width);
  UnderWay &under_way(const double *block);
  static std::size_t copied_values(int fields, const std::vector<Message> &messages);
  template <class Post>
  PetscErrorCode post_all(FieldBlock &block, const std::vector<Message> &messages, double *copies,
                          const Post &post) const;
  template <class Copy>
  void for_rows(FieldBlock &block, const std::vector<Message> &messages, double *copies, const Copy &copy) const;
  PetscErrorCode end_rows(FieldBlock &block, int width, const OccupiedRows *rows);
  bool is_copied(int d) const;
  void copy_rows(FieldBlock &block, int width) const;
  template <class Skip>
  void wrap_rows(FieldBlock &block, int width, Skip skip) const;

  const Grid *grid_;
  Comm comm_;
  std::map<int, Plan> plans_;  ///< by width
  std::vector<std::unique_ptr<UnderWay>> under_way_;
};

}  // namespace eulastic
