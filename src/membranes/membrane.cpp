#include "membranes/membrane.hpp"

#include "base/events.hpp"
#include "field/boundaries.hpp"
#include "grid/row_scratch.hpp"
#include "grid/threads.hpp"
#include "kernels/weno5.hpp"
#include "membranes/membrane_tensor.hpp"
#include "membranes/smooth_row.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace eulastic {
namespace {

using kernels::Tensor;
using kernels::Vector;

constexpr double largest_trace_ratio = 2;    // largest ratio of tr B_s between markers and grid
constexpr double largest_area_excess = 0.5;  // largest excess of the markers' area energy over that of the grid, in G_s
// Principal curvatures times the grid spacing up to which, and from which, the force of a uniform tension is all or
// nothing of the smallest tension.
constexpr double resolved_turn = 0.25, unresolved_turn = 0.4;

template <int Dim>
struct Differences {
  std::ptrdiff_t stride[3];
  Real3 h, inverse;
  explicit Differences(const Box &box, ConstView q) {
    for (int d = 0; d < 3; ++d) {
      stride[d] = q.stride(d);
      h[d] = box.spacing()[d];
      inverse[d] = 1 / h[d];
    }
  }
};

// Velocity and its gradient at the surface point nearest to a cell.
template <int Dim>
struct SurfaceFlow {
  Vector<Dim> v{};
  Tensor<Dim> L{};
};

template <int Dim>
EULASTIC_INLINE double centre_velocity(const double *v, std::ptrdiff_t s) {
  return 0.5 * (v[0] + v[s]);
}

// Interpolates velocity and gradient linearly from centres to the surface point at -distance n from a cell.
template <int Dim>
EULASTIC_INLINE SurfaceFlow<Dim> flow_at_surface(const Differences<Dim> &local, const Field &velocity,
                                                 std::ptrdiff_t at, const Vector<Dim> &n, double distance) {
  SurfaceFlow<Dim> flow;
  std::ptrdiff_t step[Dim];
  double part[Dim];
  for (int d = 0; d < Dim; ++d) {
    const double away = -distance * n[d] * local.inverse[d];
    step[d] = away > 0 ? local.stride[d] : -local.stride[d];
    part[d] = std::min(__builtin_fabs(away), 1.0);
  }
  for (int corner = 0; corner < 1 << Dim; ++corner) {
    double w = 1;
    std::ptrdiff_t o = at;
    for (int d = 0; d < Dim; ++d) {
      const bool far = corner >> d & 1;
      w *= far ? part[d] : 1 - part[d];
      o += far ? step[d] : 0;
    }
    if (w == 0) continue;
    for (int a = 0; a < Dim; ++a) {
      const double *v = velocity[a].origin + o;
      const std::ptrdiff_t s = local.stride[a];
      flow.v[a] = kernels::fma(w, centre_velocity<Dim>(v, s), flow.v[a]);
      for (int d = 0; d < Dim; ++d) {
        const std::ptrdiff_t t = local.stride[d];
        const double near = centre_velocity<Dim>(v + t, s) - centre_velocity<Dim>(v - t, s);
        const double far = centre_velocity<Dim>(v + 2 * t, s) - centre_velocity<Dim>(v - 2 * t, s);
        flow.L[a][d] = kernels::fma(w * local.inverse[d], (8 * near - far) / 12, flow.L[a][d]);
      }
    }
  }
  return flow;
}

// Returns -v.grad B + L B + B L^T. The differences are linear: weights that depend on the smoothness of each component,
// as in WENO5, would not conserve the trace of a mean of tensors in different planes.
template <int Dim>
EULASTIC_INLINE Tensor<Dim> rate_of(const Differences<Dim> &local, const Field &B, std::ptrdiff_t at,
                                    const SurfaceFlow<Dim> &flow) {
  const Tensor<Dim> b = tensor_at<Dim>(B, at);
  Tensor<Dim> rate;
  for (int x = 0; x < Dim; ++x)
    for (int y = x; y < Dim; ++y) {
      const double *q = B[kernels::position<Dim>(x, y)].origin + at;
      double carried = 0, stretched = 0;
      for (int d = 0; d < Dim; ++d) {
        carried = kernels::fma(flow.v[d] * local.inverse[d], kernels::upwind5_difference(q, local.stride[d], flow.v[d]),
                               carried);
        stretched += flow.L[x][d] * b[d][y] + b[x][d] * flow.L[y][d];
      }
      rate[x][y] = rate[y][x] = stretched - carried;
    }
  return rate;
}

}  // namespace

PetscErrorCode MembraneMechanics::find(const Phase &phase, Field &work) {
  PetscFunctionBeginUser;
  surface_fields_ = work.part(0, SurfaceCells::work_fields);
  scratch_fields_ = work.part(SurfaceCells::work_fields, work_fields - SurfaceCells::work_fields);
  PetscCall(surface_.find(phase, surface_fields_));
  PetscFunctionReturn(0);
}

PetscErrorCode MembraneMechanics::start(Phase *phase) {
  PetscFunctionBeginUser;
  const double area = phase->material.membrane.initial_area_stretch;
  const double stretch = place_.box->dimension() == 2 ? area * area : area;  // squared stretch of lengths
  for (std::size_t c = 0; c < surface_.nearest_count(); ++c) {
    const SurfaceCells::Cell &cell = surface_.all()[c];
    if (!cell.owned) continue;
    const auto set = [&](auto dim) {
      Tensor<dim> value =
          kernels::surface_tensor<dim>(tensor_at<dim>(phase->tensor.field, cell.at), normal_of<dim>(cell.normal));
      for (auto &row : value)
        for (double &entry : row) entry *= stretch;
      set_tensor<dim>(phase->tensor.field, cell.at, value);
    };
    place_.box->dimension() == 2 ? set(std::integral_constant<int, 2>()) : set(std::integral_constant<int, 3>());
  }
  PetscCall(surface_.extend(*phase, phase->tensor.field));
  PetscFunctionReturn(0);
}

// Advances B_s by Heun's method with a constant flow. First stage: next = B + dt R(B). Second stage: B = (B + next + dt
// R(next))/2, turned into the plane of the surface; the area stays above half of that at the start.
template <int Dim>
PetscErrorCode MembraneMechanics::heun(double dt, const Field &velocity, Phase *phase, Field &next, long *unresolved) {
  PetscFunctionBeginUser;
  const double least = least_area_squared(*phase);
  std::vector<long> lost_cells(row_parts(*place_.box));
  const Differences<Dim> local(*place_.box, velocity[0]);
  std::vector<SurfaceFlow<Dim>> flows(surface_.nearest_count());
  Field &tensor = phase->tensor.field;
  const auto stage = [&](bool second, std::size_t c, long *lost_count) {
    const SurfaceCells::Cell &cell = surface_.all()[c];
    if (!cell.owned) return;
    const Vector<Dim> n = normal_of<Dim>(cell.normal);
    if (!second) flows[c] = flow_at_surface<Dim>(local, velocity, cell.at, n, cell.distance);
    const Field &from = second ? next : tensor;
    const Tensor<Dim> rate = rate_of<Dim>(local, from, cell.at, flows[c]);
    Tensor<Dim> value = tensor_at<Dim>(from, cell.at);
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) value[a][b] = kernels::fma(dt, rate[a][b], value[a][b]);
    if (second) {
      const Tensor<Dim> old = tensor_at<Dim>(tensor, cell.at);
      for (int a = 0; a < Dim; ++a)
        for (int b = 0; b < Dim; ++b) value[a][b] = 0.5 * (old[a][b] + value[a][b]);
      value = kernels::project_surface<Dim>(value, n);
      *lost_count += kernels::bound_area<Dim>(n, least, &value);
    }
    set_tensor<Dim>(second ? tensor : next, cell.at, value);
  };
  const int parts = row_parts(*place_.box);
  for (const bool second : {false, true}) {
    {
      EventScope scope(Event::membrane);
      in_parallel(parts, parts, [&](int part) {
        const Piece piece(surface_.nearest_count(), part, parts);
        for (std::size_t c = piece.begin; c < piece.end; ++c) stage(second, c, &lost_cells[part]);
      });
      scope.flops(double(surface_.nearest_count()) * (Dim == 2 ? 250 : 1300));
    }
    if (!second) PetscCall(surface_.extend(*phase, next));
  }
  *unresolved = std::accumulate(lost_cells.begin(), lost_cells.end(), *unresolved);
  PetscFunctionReturn(0);
}

double MembraneMechanics::least_area_squared(const Phase &phase) {
  const double stretch = phase.material.membrane.initial_area_stretch;
  return 0.25 * std::min(1.0, stretch * stretch);
}

// Relaxes B_s of the grid to that of the markers, once per cell that the surface passes, which is faster than its
// numerical decay. Over shorter distances B_s stays consistent with force and surface of the grid. Because the decay is
// slow, a large difference means that the markers do not determine a quadratic or were carried by an unresolved flow,
// as at an edge pressed to a wall; such strains are not used.
void MembraneMechanics::relax_to_markers(const std::vector<SurfaceMarkers::Strain> &strains, const Field &velocity,
                                         double dt, Phase *phase, long *unresolved) {
  const double least = least_area_squared(*phase);
  const auto each = [&](auto dim) {
    for (const SurfaceMarkers::Strain &strain : strains) {
      const SurfaceCells::Cell &cell = surface_.all()[strain.cell];
      Field &tensor = phase->tensor.field;
      Tensor<dim> found;
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b) found[a][b] = strain.B[kernels::position<dim>(a, b)];
      const kernels::SurfaceStrain from_markers = kernels::surface_strain<dim>(found);
      const kernels::SurfaceStrain on_grid = kernels::surface_strain<dim>(tensor_at<dim>(tensor, cell.at));
      const kernels::Membrane &law = phase->material.membrane;
      const double excess = kernels::area_energy(law, from_markers) - kernels::area_energy(law, on_grid);
      if (!(from_markers.trace < largest_trace_ratio * on_grid.trace &&
            on_grid.trace < largest_trace_ratio * from_markers.trace))
        continue;
      if (!(excess < largest_area_excess * law.shear_modulus)) continue;
      double passed = 0;
      for (int d = 0; d < dim; ++d)
        passed += __builtin_fabs(centre_velocity<dim>(velocity[d].origin + cell.at, velocity[d].stride(d))) * dt /
                  place_.box->spacing()[d];
      const double share = std::min(passed, 1.0);
      for (int f = 0; f < tensor.count(); ++f) {
        double &B = tensor[f].origin[cell.at];
        B = kernels::fma(share, strain.B[f] - B, B);
      }
      Tensor<dim> value = tensor_at<dim>(tensor, cell.at);
      if (!kernels::bound_area<dim>(normal_of<dim>(cell.normal), least, &value)) continue;
      ++*unresolved;
      set_tensor<dim>(tensor, cell.at, value);
    }
  };
  place_.box->dimension() == 2 ? each(std::integral_constant<int, 2>()) : each(std::integral_constant<int, 3>());
}

PetscErrorCode MembraneMechanics::move(double dt, const Field &velocity,
                                       const std::vector<SurfaceMarkers::Strain> &strains, Phase *phase,
                                       long *unresolved) {
  PetscFunctionBeginUser;
  Field next = scratch_fields_.part(0, phase->tensor.field.count());
  if (place_.box->dimension() == 2)
    PetscCall(heun<2>(dt, velocity, phase, next, unresolved));
  else
    PetscCall(heun<3>(dt, velocity, phase, next, unresolved));
  relax_to_markers(strains, velocity, dt, phase, unresolved);
  PetscCall(extend(phase));
  PetscFunctionReturn(0);
}

// Force of membranes on the flow.

namespace {

// Interpolates to the middle between q[-s] and q[0], to fourth order.
EULASTIC_INLINE double between(const double *q, std::ptrdiff_t s) noexcept {
  return (9. / 16) * (q[-s] + q[0]) - (1. / 16) * (q[-2 * s] + q[s]);
}

// Computes div T on the faces of component a in a row. Within the few cells of delta the terms must cancel where the
// surface is flat and the tension uniform, for any direction of the surface.
template <int Dim>
EULASTIC_INLINE void divergence_row(const Field &T, int a, const Real3 &inverse, int n, int j, int k, double *out) {
  const ConstView q = T[a];
  const double *aa = q.row(j, k);
  const std::ptrdiff_t sa = q.stride(a);
  for (int i = 0; i < n; ++i) out[i] = inverse[a] * (aa[i] - aa[i - sa]);
  for (int e = 1; e < Dim; ++e) {
    const int b = (a + e) % Dim;
    const double *ab = T[kernels::position<Dim>(a, b)].row(j, k);
    const double ib = inverse[b];
    const std::ptrdiff_t sb = q.stride(b);
#pragma omp simd
    for (int i = 0; i < n; ++i) {
      const double *p = ab + i;
      const double near = between(p + sb, sa) - between(p - sb, sa);
      const double far = between(p + 2 * sb, sa) - between(p - 2 * sb, sa);
      out[i] = kernels::fma(ib, (2. / 3) * near - (1. / 12) * far, out[i]);
    }
  }
}
EULASTIC_CLONES void divergence_2d(const Field &T, int a, const Real3 &inverse, int n, int j, int k, double *out) {
  divergence_row<2>(T, a, inverse, n, j, k, out);
}
EULASTIC_CLONES void divergence_3d(const Field &T, int a, const Real3 &inverse, int n, int j, int k, double *out) {
  divergence_row<3>(T, a, inverse, n, j, k, out);
}

// Ghost layers that these differences read. The stress differs from 0 within three cells around a body, occupied rows
// extend five.
constexpr int force_reach = 2;

}  // namespace

// Finds the uniform tension and the curvatures for its force. It is the tension that all of the surface has in every
// direction. Where the surface turns within a few cells, heights miss a part of the curvature, and a sharp edge would
// not be held back; the divergence of the stress has exactly no net force.
template <int Dim>
PetscErrorCode MembraneMechanics::find_uniform_tension(const Phase &phase) {
  PetscFunctionBeginUser;
  double largest[2] = {-std::numeric_limits<double>::infinity(), 0};  // minus the tension; the turn of the surface
  {
    EventScope scope(Event::membrane);
    for (std::size_t c = 0; c < surface_.nearest_count(); ++c) {
      const SurfaceCells::Cell &cell = surface_.all()[c];
      if (!cell.owned) continue;
      const kernels::SurfaceStrain strain = kernels::surface_strain<Dim>(tensor_at<Dim>(phase.tensor.field, cell.at));
      largest[0] = std::max(largest[0], -kernels::smaller_tension<Dim>(phase.material.membrane, strain));
    }
    if (place_.exchange || largest[0] < 0) largest[1] = surface_.sharpest(surface_fields_);
  }
  if (place_.exchange)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, largest, 2, MPI_DOUBLE, MPI_MAX, place_.exchange->comm()));
  const double share = std::clamp((unresolved_turn - largest[1]) / (unresolved_turn - resolved_turn), 0.0, 1.0);
  uniform_tension_ = std::isfinite(largest[0]) ? share * std::max(-largest[0], 0.0) : 0;
  if (uniform_tension_ == 0) PetscFunctionReturn(0);
  Field work = surface_fields_.part(SurfaceCells::sharp, CapillaryForce::work_fields);
  PetscCall(capillary_.find(phase, surface_.fraction_within_walls(phase, surface_fields_[SurfaceCells::level]), work));
  PetscFunctionReturn(0);
}

// Computes delta (tau - T P) at centres, T the uniform tension, with the ghosts that the force reads; 0 elsewhere in
// rows that the force reaches.
PetscErrorCode MembraneMechanics::find_stress(const Phase &phase, Field &stress) {
  PetscFunctionBeginUser;
  EventScope scope(Event::membrane);
  const int dim = place_.box->dimension();
  for (int f = 0; f < stress.count(); ++f) clear_near_rows(*place_.box, phase.rows, force_reach, stress[f]);
  const auto set = [&](const SurfaceCells::Cell &cell, auto zero, auto P) {
    auto B = zero;
    const kernels::MembraneState state = kernels::membrane_state(
        phase.material.membrane, kernels::surface_strain<int(std::tuple_size_v<decltype(B)>)>(B));
    for (std::size_t a = 0; a < B.size(); ++a)
      for (std::size_t b = 0; b < B.size(); ++b)
        B[a][b] = cell.spread * kernels::fma(state.alpha, B[a][b], (state.beta - uniform_tension_) * P[a][b]);
    return B;
  };
  for (const SurfaceCells::Cell &cell : surface_.all()) {
    if (!cell.owned) continue;
    if (dim == 2)
      set_tensor<2>(
          stress, cell.at,
          set(cell, tensor_at<2>(phase.tensor.field, cell.at), kernels::tangential<2>(normal_of<2>(cell.normal))));
    else
      set_tensor<3>(
          stress, cell.at,
          set(cell, tensor_at<3>(phase.tensor.field, cell.at), kernels::tangential<3>(normal_of<3>(cell.normal))));
  }
  PetscCall(place_.exchange_ghosts(stress, force_reach, &phase.rows));
  fill_wall_ghosts_centred_tensor(*place_.box, stress, force_reach, &phase.rows);
  PetscFunctionReturn(0);
}

// Calls `use` with the force of the stress, then with that of bending.
PetscErrorCode MembraneMechanics::for_force_rows(const Phase &phase, const ForceRow &use,
                                                 std::vector<double> *bending_energy) {
  PetscFunctionBeginUser;
  const int dim = place_.box->dimension();
  const Real3 &h = place_.box->spacing(), inverse{1 / h[0], 1 / h[1], 1 / h[2]};
  const int n = place_.box->cells()[0];
  if (bending_energy) bending_energy->assign(surface_.all().size(), 0);
  for (const bool bending : {false, true}) {
    if (bending && !(phase.material.membrane.bending_modulus > 0)) continue;
    Field fields = scratch_fields_.part(0, bending ? MembraneBending::work_fields : phase.tensor.field.count());
    if (bending) {
      PetscCall(bending_.find(phase, smooth(), fields));
    } else {
      PetscCall(dim == 2 ? find_uniform_tension<2>(phase) : find_uniform_tension<3>(phase));
      PetscCall(find_stress(phase, fields));
    }
    EventScope scope(Event::membrane);
    in_row_parts(*place_.box, [&](const RowPart &part) {
      RowScratch scratch(*place_.box, 1);
      double *force = scratch.row(0);
      for (int k = part.k_begin; k < part.k_end; ++k)
        for (int j = part.j_begin; j < part.j_end; ++j) {
          if (phase.rows.idle(j, k)) continue;
          for (int a = 0; a < dim; ++a) {
            if (bending)
              bending_.force_row(fields, a, j, k, force);
            else
              (dim == 2 ? divergence_2d : divergence_3d)(fields, a, inverse, n, j, k, force);
            if (!bending && uniform_tension_ > 0) capillary_.add_to_row(uniform_tension_, a, j, k, force);
            use(part.number, a, j, k, force);
          }
        }
    });
    for (std::size_t c = 0; bending && bending_energy && c < bending_energy->size(); ++c)
      if (const SurfaceCells::Cell &cell = surface_.all()[c]; cell.owned)
        (*bending_energy)[c] = MembraneBending::energy(phase.material, fields, cell.at);
    scope.flops(double(phase.rows.cells()) * dim * (bending ? 6 : 12 * dim));
  }
  PetscFunctionReturn(0);
}

// Energies and power of membranes.

namespace {

// Energies per volume of a cell.
struct Energies {
  double shear, area;
  double rest, stretch;  ///< members `rest` and `stretch` of SurfaceSample
};
template <int Dim>
Energies energies_at(const Phase &phase, const SurfaceCells::Cell &cell) {
  const kernels::SurfaceStrain strain = kernels::surface_strain<Dim>(tensor_at<Dim>(phase.tensor.field, cell.at));
  const kernels::MembraneState state = kernels::membrane_state(phase.material.membrane, strain);
  const double area = kernels::area_energy(phase.material.membrane, strain), weight = cell.delta / state.area;
  return {weight * (state.energy - area), weight * area, weight, kernels::larger_stretch(strain)};
}

// Delta of the smoothed surface, whose curvatures are used: smoothing moves the surface, and its smaller area
// compensates the larger curvature.
double smoothed_delta(const Box &box, ConstView psi, std::ptrdiff_t at) {
  const double *p = psi.origin + at;
  Real3 g{};
  for (int d = 0; d < box.dimension(); ++d) g[d] = (p[psi.stride(d)] - p[-psi.stride(d)]) / (2 * box.spacing()[d]);
  return std::sqrt((g[0] * g[0] + g[1] * g[1]) + g[2] * g[2]);
}

}  // namespace

std::vector<SurfaceSample> MembraneMechanics::sample(const Phase &phase,
                                                     const std::vector<double> &bending_energy) const {
  const Box &box = *place_.box;
  const double volume = box.cell_volume();
  std::vector<SurfaceSample> samples;
  samples.reserve(surface_.all().size());
  for (std::size_t c = 0; c < surface_.all().size(); ++c) {
    const SurfaceCells::Cell &cell = surface_.all()[c];
    if (!cell.owned) continue;
    const Energies energies = box.dimension() == 2 ? energies_at<2>(phase, cell) : energies_at<3>(phase, cell);
    const double bending = bending_energy[c] > 0 ? bending_energy[c] * smoothed_delta(box, smooth(), cell.at) : 0;
    samples.push_back({0,
                       cell.place,
                       cell.delta,
                       energies.rest,
                       energies.stretch,
                       {},
                       energies.shear * volume,
                       energies.area * volume,
                       bending * volume});
  }
  return samples;
}

PetscErrorCode MembraneMechanics::measure(const Phase &phase, const Field &velocity, const WallFilm &film,
                                          std::vector<ExactSums> *sum, std::vector<SurfaceSample> *samples) {
  PetscFunctionBeginUser;
  const int n = place_.box->cells()[0], first = place_.box->layout().begin[0];
  std::vector<double> bending;
  PetscCall(for_force_rows(
      phase,
      [&](int part, int a, int j, int k, double *force) {
        const double *v = velocity[a].row(j, k);
        for (int i = 0; i < n; ++i) force[i] *= -v[i];
        (*sum)[part].add_row(power, force, n, first);
      },
      &bending));
  EventScope scope(Event::sums);
  film.add_power(phase, velocity, power, &sum->front());
  film.add_energy(phase, stored, &sum->front());
  std::vector<SurfaceSample> found = sample(phase, bending);
  add_stored_energy(found, place_.box->cell_volume(), &sum->front());
  if (!samples || !phase.label) PetscFunctionReturn(0);
  std::vector<int> labels;
  PetscCall(surface_.find_labels(phase, surface_fields_, &labels));  // overwrites fields that sample() reads
  std::size_t next = 0;
  for (std::size_t c = 0; c < labels.size(); ++c)
    if (surface_.all()[c].owned) found[next++].label = labels[c];
  set_velocities(velocity, &found);
  samples->insert(samples->end(), found.begin(), found.end());
  PetscFunctionReturn(0);
}

void MembraneMechanics::set_velocities(const Field &velocity, std::vector<SurfaceSample> *samples) {
  for (SurfaceSample &sample : *samples) {
    const Int3 &c = sample.place;
    for (int d = 0; d < velocity.count(); ++d) {
      const double *face = &velocity[d](c[0], c[1], c[2]);
      sample.velocity[d] = 0.5 * (face[0] + face[velocity[d].stride(d)]);
    }
  }
}

void MembraneMechanics::add_stored_energy(const std::vector<SurfaceSample> &samples, double volume, ExactSums *sum) {
  for (const SurfaceSample &s : samples) sum->add(stored, (s.shear_energy + s.area_energy + s.bending_energy) / volume);
}

}  // namespace eulastic
