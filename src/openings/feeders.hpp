// Stretches of the box that feed their inflow sides: what passes their end comes in again, velocity and bodies
// (docs/method.md, section 20).
#pragma once

#include "base/petsc.hpp"
#include "field/phase.hpp"
#include "field/sides.hpp"
#include "grid/domain.hpp"

#include <map>
#include <string>
#include <vector>

namespace eulastic {

class Feeders {
public:
  /// Cells beyond the end of the stretch that a body must have passed, all of it: it comes in as far from the side.
  static constexpr int beyond = 2;

  Feeders() = default;
  Feeders(const Feeders &) = delete;
  Feeders &operator=(const Feeders &) = delete;
  ~Feeders();
  PetscErrorCode create(const Domain &domain, const BoxSides &sides);
  int count() const { return static_cast<int>(stretches_.size()); }
  /// One line if rigid bodies are not the same all along a stretch.
  PetscErrorCode check_lumen(const std::vector<Phase> &phases, std::string *wrong) const;

  /// Normal velocities on the sides at `time`: those at the ends of the stretches, and what the flow rate lacks with
  /// the profile of the side. Three ghosts of `velocity` along the planes.
  PetscErrorCode feed_velocity(double time, const Field &velocity, BoxSides *sides) const;
  /// The same from what is on the sides already.
  PetscErrorCode recall_velocity(const Field &velocity, BoxSides *sides) const;

  /// Finds out which bodies are in which stretch; `boxed`: those of this rank in boxes of their own.
  PetscErrorCode start(const std::vector<Phase> &phases, const std::vector<BodyInBox> &boxed);
  /// Those that have passed the end of theirs, ascending; they keep being named until forget().
  PetscErrorCode find_passed(const std::vector<Phase> &phases, const std::vector<BodyInBox> &boxed,
                             std::vector<int> *labels) const;
  /// Where a body comes in, relative to where it is.
  Int3 shift_of(int label) const;
  /// A body is not in its stretch any more; another one has come into that.
  void forget(int label) { inside_.erase(label); }
  void come_in(int label, int other) { inside_[other] = inside_.at(label); }

  /// By the labels of bodies: which stretch each is in, if in any. All that a restart needs.
  const std::map<int, int> &inside() const { return inside_; }
  /// Of which every rank names some. Collective.
  PetscErrorCode set_inside(const std::map<int, int> &here);

private:
  struct Stretch {
    int d, high, cells;
    MPI_Comm line;  ///< ranks along d
  };
  template <class Visit>  ///< those of a block, and those just beyond the stretch
  static void for_cells(const Box &box, const Stretch &stretch, const Visit &visit);
  template <class Visit>
  void for_bodies(const std::vector<Phase> &phases, const std::vector<BodyInBox> &boxed, const Visit &visit) const;

  const Domain *domain_ = nullptr;
  std::vector<Stretch> stretches_;
  std::map<int, int> inside_;  ///< the same on all ranks
};

}  // namespace eulastic
