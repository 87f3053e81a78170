#include "scene/voxels.hpp"

#include "base/events.hpp"
#include "base/one_line.hpp"
#include "base/rank_zero.hpp"
#include "bodies/closed_surface.hpp"
#include "bodies/fill_phase.hpp"
#include "bodies/resample.hpp"
#include "io/fail_together.hpp"
#include "io/stl_file.hpp"
#include "io/volume_file.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace eulastic {
namespace {

// All members are collective.
class VoxelBody {
public:
  std::string open(const VoxelSpec &voxels, const DomainShape &grid) {
    path_ = voxels.path;
    const std::string wrong = on_rank_0([&] { return open_locally(voxels, grid); });
    share(&triangles_);
    share(&box_);
    return wrong;
  }

  std::string fill(const CellWindow &window, View fraction) {
    if (!triangles_.empty()) {
      const std::string wrong = fill_surface(window, triangles_, fraction);
      return wrong.empty() ? wrong : path_ + ": " + wrong;
    }
    const auto read = [this](const Int3 &begin, const Int3 &end, double *values) {
      const std::string wrong = on_rank_0([&] { return volume_->read(begin, end, values); });
      std::size_t bytes = sizeof *values;
      for (int d = 0; d < 3; ++d) bytes *= end[d] - begin[d];
      (void)broadcast_bytes(values, bytes);
      return wrong;
    };
    return resample(window, box_, read, fraction);
  }

private:
  std::string open_locally(const VoxelSpec &voxels, const DomainShape &grid) {
    VolumeFormat format;
    std::string file, dataset, wrong = find_volume(voxels.path, &format, &file, &dataset);
    if (!wrong.empty()) return wrong;
    if (format == VolumeFormat::stl) return open_surface(voxels, file, grid);
    wrong = format == VolumeFormat::hdf5 ? open_hdf5_volume(file, dataset, &volume_) : open_nrrd_volume(file, &volume_);
    if (!wrong.empty()) return wrong;
    return place_volume(voxels, file, grid);
  }

  std::string open_surface(const VoxelSpec &voxels, const std::string &file, const DomainShape &grid) {
    if (std::string wrong = read_stl(file, &triangles_); !wrong.empty()) return wrong;
    if (const std::string wrong = why_not_closed(triangles_); !wrong.empty()) return file + ": " + wrong;
    Real3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
    for (Triangle &triangle : triangles_)
      for (Real3 &corner : triangle)
        for (int d = 0; d < 3; ++d) {
          const double unit = std::isnan(voxels.spacing[d]) ? 1 : voxels.spacing[d];
          corner[d] = (std::isnan(voxels.origin[d]) ? 0 : voxels.origin[d]) + unit * corner[d];
          low[d] = std::min(low[d], corner[d]);
          high[d] = std::max(high[d], corner[d]);
        }
    if (enclosed_volume(triangles_) == 0)
      return file + ": the surface encloses no volume; accepted: a closed surface around a body";
    return why_outside(file, grid, low, high);
  }

  // What options say comes first, then the file, then: the volume fills the box. The file's origin goes with its own
  // spacing alone. A plane fills the box in z.
  std::string place_volume(const VoxelSpec &voxels, const std::string &file, const DomainShape &grid) {
    box_.count = volume_->count();
    const bool flat = grid.cells[2] == 1;
    if (flat && box_.count[2] != 1)
      return file + ": " + std::to_string(box_.count[2]) + " voxels in z; accepted in 2-D (one cell in z): 1";
    const bool no_spacing = std::isnan(voxels.spacing[0]) && std::isnan(volume_->spacing()[0]);
    if (no_spacing && std::isnan(voxels.origin[0]) && !std::isnan(volume_->corner()[0]))
      return file + ": it has an origin without a spacing; accepted: both of them in the file, or as options";
    Real3 high{};
    for (int d = 0; d < 3; ++d) {
      double spacing = voxels.spacing[d], corner = voxels.origin[d];
      if (std::isnan(spacing)) {
        spacing = volume_->spacing()[d];
        if (std::isnan(corner)) corner = volume_->corner()[d];  // in units of the file, as its spacing
      }
      const bool fills = flat && d == 2;
      box_.spacing[d] = fills || std::isnan(spacing) ? grid.length[d] / box_.count[d] : spacing;
      box_.corner[d] = fills || std::isnan(corner) ? 0 : corner;
      high[d] = box_.corner[d] + box_.count[d] * box_.spacing[d];
    }
    return why_outside(file, grid, box_.corner, high);
  }

  static std::string why_outside(const std::string &file, const DomainShape &grid, const Real3 &low,
                                 const Real3 &high) {
    for (int d = 0; d < 3; ++d)
      if (!(low[d] < grid.length[d] && high[d] > 0)) {
        return file +
               print(": it is outside the box: %c = %.6g ... %.6g; accepted: a volume that reaches into 0 ... %.6g",
                     "xyz"[d], low[d], high[d], grid.length[d]);
      }
    return {};
  }

  std::string path_;
  std::unique_ptr<VolumeFile> volume_;  // of rank 0
  VoxelBox box_;
  std::vector<Triangle> triangles_;  // none: a volume
};

std::string about(const std::string &option, const std::string &wrong) {
  return wrong.empty() ? wrong : option + ": " + wrong;
}
std::string option_of(const SpeciesSpec &spec) { return "-" + spec.name + "_voxels"; }

constexpr int most_cells = 1 << 24;  // in memory at a time

bool on_any_rank(bool here) {
  int any = here;
  (void)MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, run_communicator());
  return any > 0;
}

}  // namespace

std::string read_cells(const VoxelSpec &voxels, const std::string &option, const DomainShape &grid,
                       const CellWindow &cells, const VisitLayers &visit) {
  const Int3 &n = cells.size;
  const int end = cells.begin[2] + n[2];
  const int step =
      std::max(1, static_cast<int>(std::min(most_cells / std::max(1.0, double(n[0]) * n[1]), double(n[2]))));
  std::vector<double> phi;
  for (int k = cells.begin[2]; on_any_rank(k < end); k += step) {
    const CellWindow window(grid, {cells.begin[0], cells.begin[1], k}, {n[0], n[1], std::clamp(end - k, 0, step)});
    phi.resize(std::size_t(n[0]) * n[1] * window.size[2]);
    const View fraction{phi.data(), n[0], std::ptrdiff_t(n[0]) * n[1]};
    VoxelBody body;  // anew: files may have to be read from the front
    std::string wrong = body.open(voxels, grid);
    if (wrong.empty()) wrong = body.fill(window, fraction);
    if (on_any_rank(!wrong.empty())) return about(option, wrong);
    if (voxels.invert)
      for (double &q : phi) q = 1 - q;
    if (window.size[2] > 0) visit(window, fraction);
  }
  return {};
}

std::string read_voxels(const SpeciesSpec &spec, const DomainShape &grid, const CellWindow &cells,
                        const VisitLayers &visit) {
  return read_cells(spec.voxels, option_of(spec), grid, cells, visit);
}

namespace {

// The volume does not depend on the cells, so that few will do.
std::string measure(const SpeciesSpec &spec, DomainShape grid, SolidMask *mask, double *volume) {
  if (!mask)
    for (int &n : grid.cells) n = std::min(n, 64);
  const Int3 &n = grid.cells;
  double sum = 0;
  bool all = true;
  const std::string wrong = read_voxels(spec, grid, {grid, {}, n}, [&](const CellWindow &window, ConstView fraction) {
    for (int k = 0; k < window.size[2]; ++k)
      for (int j = 0; j < n[1]; ++j) {
        const double *phi = fraction.row(j, k);
        sum += std::accumulate(phi, phi + n[0], 0.0);
        all = all && std::all_of(phi, phi + n[0], [](double q) { return q == 1; });
      }
    if (mask) mask->add(window, fraction);
  });
  for (int d = 0; d < grid.dimension(); ++d) sum *= grid.spacing(d);
  *volume = sum;
  if (!wrong.empty()) return wrong;
  if (sum == 0)
    return about(option_of(spec),
                 spec.voxels.path + " has nothing solid in the box; accepted: a file with a solid part inside the box");
  if (all && spec.law == Law::rigid)
    return about(
        option_of(spec),
        spec.voxels.path + " fills all of the box and leaves no fluid; accepted: a body that fills a part of the box");
  return {};
}

}  // namespace

std::string measure_voxels(const std::vector<SpeciesSpec> &species, const DomainShape &grid, bool masks,
                           SolidBodies *solids, std::vector<double> *volumes) {
  volumes->assign(species.size(), 0);
  for (std::size_t s = 0; s < species.size(); ++s) {
    if (species[s].shape != Shape::voxels) continue;
    if (masks) solids->masks.emplace_back(grid);
    const std::string wrong = measure(species[s], grid, masks ? &solids->masks.back() : nullptr, &(*volumes)[s]);
    if (!wrong.empty()) return wrong;
    solids->volume += (*volumes)[s];
  }
  return {};
}

PetscErrorCode fill_voxels(const Domain &domain, const SpeciesSpec &spec, int label, Phase *phase, Places *places) {
  PetscFunctionBeginUser;
  EventScope scope(Event::bodies);
  const View fraction = phase->fraction[0], name = phase->label[0];
  VoxelBody body;
  PetscCall(fail_together(domain.comm(), about(option_of(spec), body.open(spec.voxels, domain.domain_shape()))));
  PetscCall(fail_together(domain.comm(), about(option_of(spec), body.fill(domain, fraction))));
  for_points(domain.rows(), [&](int i, int j, int k) {
    double &phi = fraction(i, j, k);
    if (spec.voxels.invert) phi = 1 - phi;
    if (phi > 0) name(i, j, k) = label;
  });
  stretch_phase(domain, spec, phase);
  Real3 middle;
  for (int d = 0; d < 3; ++d) middle[d] = domain.domain_shape().length[d] / 2;
  *places = {{middle, {}}};
  PetscFunctionReturn(0);
}

}  // namespace eulastic
