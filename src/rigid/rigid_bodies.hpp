// The rigid bodies of a scene: finds the faces of the velocity that are inside them, and those beside their surfaces,
// at the start and, where bodies travel, for every step.
#pragma once

#include "base/petsc.hpp"
#include "bodies/volume_fraction.hpp"
#include "field/ghost_exchange.hpp"
#include "field/phase.hpp"
#include "field/rigid_faces.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Where the surface crosses a link is found from the shape itself; of bodies from files that stay from phi,
/// interpolated, = 1/2, of those that travel from a LevelMap of it. The place of what travels is a function of time
/// alone: nothing of it needs to be saved.
class RigidBodies {
public:
  RigidBodies(const Domain &domain, GhostExchange &exchange);
  /// Owned cells of `phase` are set, and all `places` are known. Collective. Bodies get their indices as they come;
  /// `first_label`: of the first. `wrong`: one line on a body from a file that cannot travel, or nothing.
  PetscErrorCode add(const SpeciesSpec &spec, const Places &places, int first_label, Phase *phase, std::string *wrong);
  /// Of the bodies added last.
  const Surface *newest_surface() const { return species_.back().surface.get(); }
  bool exist() const { return faces_.count > 0; }
  bool travel() const { return faces_.travels; }
  /// The faces inside at a time, and links that end where surfaces are at another; nothing can be added afterwards.
  /// Collective.
  PetscErrorCode place(double time, double surface_time);
  const RigidFaces &faces() const { return faces_; }
  /// Of bodies that do not travel, RigidFaces::gaps from the owned solid fractions of all phases; after place().
  /// Collective.
  PetscErrorCode measure_gaps(const std::vector<Phase> &phases);
  /// Owned phi and labels of the phases that travel, at a time. They get new memory; the rest of them is the caller's.
  PetscErrorCode fill(double time, std::vector<Phase> *phases) const;
  /// One line if, where they were placed last, bodies of which one travels touch.
  const std::string &touching() const { return touching_; }
  std::size_t bytes() const;

private:
  static constexpr int images = 27;  ///< of a body: itself and its neighbours across periodic sides
  static int image_of(int body, const Int3 &shift);
  /// A body, or all bodies of a file.
  struct Source {
    std::shared_ptr<const Surface> surface;  ///< null: of a file, and stays
    std::unique_ptr<PlacedBody> body;
    std::unique_ptr<PlacedBody>
        before;  ///< of what turns: at the time of the surfaces, but for the place of its centre
    BodyPlace start;
  };
  struct Species {
    SpeciesSpec spec;
    Places places;
    int first_label;
    std::shared_ptr<const Surface> surface;
    RigidMass mass;  ///< of a body that turns, in its own coordinates
  };
  PetscErrorCode map_file(const SpeciesSpec &spec, const Phase &phase, std::shared_ptr<const Surface> *surface,
                          RigidMass *mass, std::string *wrong);
  BodyPlace place_of(const BodyPlace &start, const RigidMotion &motion, double time) const;
  void put(int index, const BodyPlace &place);
  int index_of(const std::string &species, int label) const;
  void set_gaps(const std::vector<double> &moments);
  PetscErrorCode measure_pistons();
  template <class Visit>
  void for_faces(int a, int index, const Visit &visit);
  void mark(int a, int index);
  void clear(int a, int index);
  void mark_file(int a, ConstView phi, int index);
  double crossing(int image, const Real3 &outside, const Real3 &inside, double level_outside,
                  double level_inside) const;
  RigidFaces::Cut cut_at(int a, int i, int j, int k);
  RigidFaces::Component component(int a, const Int3 &layers);
  void note_contact(int image, int other);
  void say_touching(const std::array<int, 2> &bodies, double time);

  const Domain &domain_;
  GhostExchange &exchange_;
  RigidFaces faces_;
  std::vector<Source> sources_;   ///< of every body
  std::vector<Species> species_;  ///< by motion
  std::array<Field, 3> inside_;   ///< of every component: 1 + image of the body a face is in
  std::array<Field, 3> level_;    ///< of files, else empty
  std::array<int, 2> contact_{};  ///< indices of two bodies that touch, ascending; none: equal
  std::string touching_;
};

}  // namespace eulastic
