#include "scene/config.hpp"

namespace eulastic {

std::string Config::why_no_boxes(const SpeciesSpec &spec) const {
  const bool has_box = spec.shape == Shape::sphere || spec.shape == Shape::biconcave ||
                       spec.shape == Shape::ellipsoid || spec.shape == Shape::state;
  if (spec.law == Law::rigid || spec.material().anchored) return "soft bodies that are free to move";
  if (!has_box) return "-" + spec.name + "_shape sphere, biconcave or ellipsoid";
  if (!body_series) return "-body_series true";
  if (!method.allows_boxed_bodies()) return "-method fast and -interface_scheme plic";
  return {};
}

}  // namespace eulastic
