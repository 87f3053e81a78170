#include "scene/config.hpp"

namespace eulastic {

std::string Config::why_no_boxes(const SpeciesSpec &spec) const {
  if (spec.law == Law::rigid || spec.material().anchored) return "soft bodies that are free to move";
  if (!is_closed(spec.shape) && spec.shape != Shape::state)
    return "-" + spec.name + "_shape sphere, biconcave or ellipsoid";
  if (!body_series) return "-body_series true";
  if (!method.allows_boxed_bodies()) return "-method fast and -interface_scheme plic";
  return {};
}

}  // namespace eulastic
