// All parameters of a run, validated. The member initialisers are the defaults that -help shows.
#pragma once

#include "adhesion/adhesion_pair.hpp"
#include "bodies/placement.hpp"
#include "field/boundaries.hpp"
#include "field/material.hpp"
#include "field/open_boundaries.hpp"
#include "field/phase.hpp"
#include "flow/initial_velocity.hpp"
#include "grid/box.hpp"
#include "parts/method.hpp"

#include <string>
#include <vector>

namespace eulastic {

/// Values of -boundary_x and -boundary_xmin.
enum class BoundaryChoice { periodic, wall, symmetry };
enum class SideChoice { same, wall, symmetry, inflow, pressure, outflow };

struct BoundaryControl {
  std::array<BoundaryChoice, 3> both{};
  std::array<std::array<SideChoice, 2>, 3> side{};  ///< [direction][low, high]; `same` as -boundary_x says

  /// Whether direction d is not periodic: one side alone cannot be.
  bool bounded(int d) const {
    return both[d] != BoundaryChoice::periodic || (side[d][0] != SideChoice::same && side[d][1] != SideChoice::same);
  }
  BoundaryKind kind(int d, int high) const {
    if (side[d][high] == SideChoice::same)
      return both[d] == BoundaryChoice::symmetry ? BoundaryKind::symmetry : BoundaryKind::wall;
    static_assert(int(SideChoice::outflow) - 1 == int(BoundaryKind::outflow), "the same order");
    return static_cast<BoundaryKind>(static_cast<int>(side[d][high]) - 1);
  }
  bool is(BoundaryKind wanted, int d, int high) const { return bounded(d) && kind(d, high) == wanted; }
  bool is_wall(int d, int high) const { return is(BoundaryKind::wall, d, high); }
};

/// Values of the options of one wall, inflow or pressure boundary. `velocity`, `flow_rate` and `pressure` are a number
/// or the path of a table over time, as given; empty: not given.
struct OpeningSpec {
  std::string profile = "uniform";  ///< uniform, developed, or a file
  std::string velocity;             ///< into the box; or 3 numbers, the velocity of a wall
  std::string flow_rate;            ///< into the box
  std::string pressure = "0";       ///< on the boundary
  double frequency = 0, phase = 0;  ///< of velocity and flow rate: angular, 1 / time, and rad
  double generator_length = 0;      ///< length of the inlet generator; 0: none
  double period = 0;                ///< after which the table of velocity, flow rate or pressure repeats; 0: never
  bool hold = false;                ///< the first and the last value of the table hold before and after it
  double resistance = 0;            ///< behind the side
  Real3 windkessel{};               ///< or resistance, capacity, resistance; 0,0,0: none
  double windkessel_start = 0;      ///< pressure of the capacity at t = 0

  bool from_file() const { return profile != "uniform" && profile != "developed"; }
};

/// The part of an inflow or open boundary that rigid bodies leave open at t = 0. A lumen is a connected part of it; its
/// width is taken at its widest position, as the shorter of the two chords along the grid.
struct OpenPart {
  double share = 1;  ///< of the area of the side
  double area = 0;   ///< in 2-D a length
  int lumens = 0;    ///< 0 also where bodies come from -initial_state
  double width = 0;  ///< of the widest lumen; infinite where no wall is
  double cells = 0;  ///< across the narrowest one
  /// Bits 1 << (2 d + high) of this and of the other inflow and open boundaries to which rigid bodies leave a way; 0 if
  /// no other exists, or no rigid body.
  unsigned connected = 0;
};

struct TimeControl {
  double end = 0;
  double step = 0;     ///< 0 = automatic
  long steps_max = 0;  ///< 0 = no limit
};

struct OutputControl {
  std::string directory = "output";
  bool overwrite = false;
  bool snapshot_exact = false;   ///< at the multiples of the interval, else at the steps that reach them
  double snapshot_interval = 0;  ///< simulated time; 0 = no snapshots, else the start and the end are written too
  std::vector<std::string> snapshot_fields{"velocity", "pressure", "solid_fraction", "body", "wall_shear_stress"};
  bool snapshot_single = true;  ///< single precision
  bool snapshot_vti = false;    ///< also a file of VTK's XML image data for each snapshot
  double series_interval = 0;   ///< simulated time; after parsing never 0: time_end / 200 unless given
};

/// One profile: the means over planes of cells, or the values along a line through `line`.
struct ProfileSpec {
  enum class Kind { none, mean, line } kind = Kind::none;
  Real3 line{};
};

struct SampleControl {
  std::vector<Real3> probes;
  std::array<ProfileSpec, 3> profile;  ///< along x, y, z
  double profile_interval = 0;         ///< simulated time; 0 = only the end
};

struct CheckpointControl {
  double interval = 0;       ///< simulated time; 0 = none
  double wall_minutes = 30;  ///< since the last one; 0 = none
  long keep = 2;
  double stop_after_minutes = 0;  ///< of wall time; 0 = never
  std::string restart;            ///< a checkpoint, or a directory with some; empty = begin at t = 0
};

/// Bounds that stop a run; 0 = none.
struct GuardControl {
  double cfl = 1;              ///< sum of max |v_i| dt/h_i
  double divergence = 0.2;     ///< rms(div v) h/U
  double mach = 1;             ///< U/beta of artificial compressibility
  double volume_drift = 0.2;   ///< relative, of any body
  double energy_growth = 0.3;  ///< energy generated by the numerics, per energy held and supplied meanwhile
  double memory = 1;           ///< needed by the ranks of a node, per memory it has
};

struct Config {
  GridSpec grid;
  BoundaryControl boundary;
  std::array<std::array<OpeningSpec, 2>, 3> openings;
  BoundaryConditions sides;  ///< and grid.boundary: after parsing, as `boundary` and `openings` say
  std::array<std::array<OpenPart, 2>, 3> open_parts;  ///< by validate()
  Fluid fluid;
  InitialFlow initial;
  std::string initial_state;  ///< HDF5 file; empty = none
  std::vector<SpeciesSpec> species;
  bool body_series = true;            ///< bodies are labelled, tracked and measured
  std::vector<Places> places;         ///< of the bodies of every species, walls and posts everywhere; by validate()
  std::vector<double> solid_volumes;  ///< of every species, 0 if not from a file; by validate()
  AdhesionSpec adhesion;
  Method method = method_preset(MethodKind::fast);
  TimeControl time;
  OutputControl output;
  SampleControl samples;
  CheckpointControl checkpoint;
  GuardControl guard;
  int threads = 1;       ///< per rank
  bool balance = false;  ///< ranks get equal work instead of equal numbers of cells
  bool check_only = false;
  int ranks = 0;  ///< that -check_only assumes; 0: those of the communicator
  bool print_options = false;

  /// Null of a phase that no species has.
  const SpeciesSpec *species_of(const Phase &phase) const {
    for (const SpeciesSpec &spec : species)
      if (spec.name == phase.species) return &spec;
    return nullptr;
  }
  /// Whether several bodies of a species lie in boxes of their own (boxes/free_bodies.hpp), where they stay separate;
  /// else they share a phase of the grid, where they merge.
  bool boxes(const SpeciesSpec &spec) const { return spec.contact != Contact::merge && why_no_boxes(spec).empty(); }
  /// The requirement that keeps the bodies of a species out of boxes; empty if they can have boxes.
  std::string why_no_boxes(const SpeciesSpec &spec) const;
  /// Whether `count` bodies of a species lie in boxes: a single one stays on the grid, unless it adheres.
  bool lie_in_boxes(std::size_t which, int count) const {
    return boxes(species[which]) && (count > 1 || has_inlet_generators(sides) || adheres(which));
  }
  /// Whether the bodies of a species lie in boxes. After `places` are known.
  bool lies_in_boxes(std::size_t which) const { return lie_in_boxes(which, places[which].count); }
  bool adheres(std::size_t which) const {
    for (const AdhesionPair &pair : adhesion.pairs)
      if (pair.has(static_cast<int>(which))) return true;
    return false;
  }
};

}  // namespace eulastic
