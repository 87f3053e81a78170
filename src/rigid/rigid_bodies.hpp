// The rigid bodies of a scene. This class finds the velocity faces inside them and those beside their surfaces, at the
// start and, if bodies travel, in every step.
#pragma once

#include "base/petsc.hpp"
#include "bodies/volume_fraction.hpp"
#include "field/ghost_exchange.hpp"
#include "field/phase.hpp"
#include "field/rigid_faces.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// The point where a link crosses a surface follows from the exact shape; for bodies from files it is where
/// interpolated phi is 1/2 (bodies at rest), or follows from a LevelMap of phi (travelling bodies). The place of a
/// travelling body is a function of time alone, so that no state needs to be saved.
class RigidBodies {
public:
  RigidBodies(const Domain &domain, GhostExchange &exchange);
  /// Adds the bodies of a species; their indices follow the order of calls. Owned cells of `phase` must be set, and all
  /// `places` known. `first_label`: label of the first one. `wrong`: one line if a body from a file cannot travel, else
  /// empty. Collective.
  PetscErrorCode add(const SpeciesSpec &spec, const Places &places, int first_label, Phase *phase, std::string *wrong);
  /// Surface of the bodies added last.
  const Surface *newest_surface() const { return species_.back().surface.get(); }
  bool exist() const { return faces_.count > 0; }
  bool travel() const { return faces_.travels; }
  /// Finds the faces inside bodies at `time`, and links to surfaces at `surface_time`. No body may be added afterwards.
  /// Collective.
  PetscErrorCode find_faces(double time, double surface_time);
  const RigidFaces &faces() const { return faces_; }
  /// Computes RigidFaces::gaps of bodies that do not travel from the owned solid fractions of all phases. Call after
  /// find_faces(). Collective.
  PetscErrorCode measure_gaps(const std::vector<Phase> &phases);
  /// Sets owned phi and labels of the travelling phases at `time`, in new memory. The caller updates ghosts and rows.
  PetscErrorCode fill(double time, std::vector<Phase> *phases) const;
  /// One line if, in the last find_faces(), two bodies touch of which one travels; else empty.
  const std::string &contact_message() const { return contact_message_; }
  std::size_t bytes() const;

private:
  static constexpr int images = 27;  ///< a body and its neighbours across periodic boundaries
  static int image_of(int body, const Int3 &shift);
  /// A body, or all bodies of one file.
  struct Source {
    std::shared_ptr<const Surface> surface;  ///< null: from a file and at rest
    std::unique_ptr<PlacedBody> body;
    /// For rotating bodies: the body with its orientation at surface_time and its centre at `time`.
    std::unique_ptr<PlacedBody> before;
    BodyPlace start;
  };
  struct Species {
    SpeciesSpec spec;
    Places places;
    int first_label;
    std::shared_ptr<const Surface> surface;
    RigidMass mass;  ///< of a rotating body, in its own coordinates
  };
  PetscErrorCode map_file(const SpeciesSpec &spec, const Phase &phase, std::shared_ptr<const Surface> *surface,
                          RigidMass *mass, std::string *wrong);
  BodyPlace position_at(const BodyPlace &start, const RigidMotion &motion, double time) const;
  void set_position(int index, const BodyPlace &place);
  int index_of(const std::string &species, int label) const;
  void set_gaps(const std::vector<double> &moments);
  PetscErrorCode measure_pistons();
  template <class Visit>
  void for_faces(int a, int index, const Visit &visit);
  void mark(int a, int index);
  void clear(int a, int index);
  double periods(int d, double way) const;
  void mark_file(int a, ConstView phi, int index);
  double crossing(int image, const Real3 &outside, const Real3 &inside, double level_outside,
                  double level_inside) const;
  RigidFaces::Cut cut_at(int a, int i, int j, int k);
  RigidFaces::Component component(int a, const Int3 &layers);
  void note_contact(int image, int other);
  void report_contact(const std::array<int, 2> &bodies, double time);

  const Domain &domain_;
  GhostExchange &exchange_;
  RigidFaces faces_;
  std::vector<Source> sources_;   ///< for each body
  std::vector<Species> species_;  ///< by index of the motion
  std::array<Field, 3> inside_;   ///< for each component: 1 + image of the body that contains the face, else 0
  std::array<Field, 3> level_;    ///< 1/2 - phi of bodies from files at rest, else empty
  std::array<int, 2> contact_{};  ///< indices of two bodies in contact, ascending; equal: none
  std::string contact_message_;
};

}  // namespace eulastic
