#include "field/surface_marker.hpp"

#include <algorithm>

namespace eulastic {

std::array<double, SurfaceMarker::numbers> SurfaceMarker::packed() const {
  std::array<double, numbers> values{double(number),  double(label),   double(phase),
                                     double(cell[0]), double(cell[1]), double(cell[2])};
  std::copy_n(offset.begin(), 3, values.begin() + 6);
  std::copy_n(rest.begin(), 3, values.begin() + 9);
  std::copy_n(normal.begin(), 3, values.begin() + 12);
  std::copy_n(metric.begin(), 6, values.begin() + 15);
  return values;
}

SurfaceMarker SurfaceMarker::unpacked(const double *values) {
  SurfaceMarker marker;
  marker.number = static_cast<std::int64_t>(values[0]);
  marker.label = static_cast<int>(values[1]);
  marker.phase = static_cast<int>(values[2]);
  for (int d = 0; d < 3; ++d) marker.cell[d] = static_cast<int>(values[3 + d]);
  std::copy_n(values + 6, 3, marker.offset.begin());
  std::copy_n(values + 9, 3, marker.rest.begin());
  std::copy_n(values + 12, 3, marker.normal.begin());
  std::copy_n(values + 15, 6, marker.metric.begin());
  return marker;
}

}  // namespace eulastic
