#include "app/not_supported.hpp"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <utility>
#include <vector>

namespace eulastic {
namespace {

using Words = std::vector<std::string>;

const std::vector<std::pair<Words, std::string>> &missing() {
  static const std::vector<std::pair<Words, std::string>> table{
      {{"density"}, "bodies have the density of the fluid: -fluid_density is that of both"},
      {{"buoyancy", "gravity", "sedimentation"},
       "bodies are as dense as the fluid, so that gravity moves nothing; -body_force drives both, -NAME_body_force one "
       "species alone"},
      {{"inlet", "outlet", "neumann", "dirichlet", "farfield"},
       "a side of the box is periodic, wall, symmetry, inflow, pressure or outflow: -boundary_x for both sides of a "
       "direction, -boundary_xmin and -boundary_xmax for each"},
      {{"prescribed", "torque"},
       "bodies go with the flow, or are rigid (-NAME_law rigid) and go as -NAME_velocity and -NAME_angular_velocity "
       "say: "
       "a force on a rigid one cannot be given"},
      {{"shell", "plate"}, "membranes (-NAME_law membrane) are thin: they resist shear, change of area and bending"},
      {{"marangoni", "surfactant", "wetting"},
       "-NAME_surface_tension is one number for a species, and surfaces meet walls at 90 degrees"},
      {{"poisson", "youngs", "young", "bulk", "compressibility", "compressible", "lame"},
       "fluid and bodies are incompressible; -NAME_shear_modulus is a third of Young's modulus"},
      {{"plastic", "plasticity", "viscoelastic", "fibre", "fiber", "anisotropy", "anisotropic", "active", "damage",
        "ogden", "hookean", "stvk"},
       "bodies are isotropic and elastic, neo_hookean or mooney_rivlin, beside a viscosity"},
      {{"newtonian", "carreau", "rheology", "turbulence", "turbulent", "les", "rans", "smagorinsky"},
       "the fluid is Newtonian and every eddy is resolved"},
      {{"temperature", "heat", "thermal", "concentration", "diffusion", "scalar", "solute", "salt", "charge"},
       "velocity, pressure and bodies are all that is computed"},
      {{"adhesion", "friction", "repulsion", "lubrication", "aggregation"},
       "bodies that touch are kept apart by what the grid resolves of the fluid between them; no other law of contact"},
      {{"refinement", "refine", "amr", "adaptive", "stretching", "grading", "unstructured"},
       "one uniform grid; -grid_cells and -grid_length"},
      {{"gpu", "cuda", "hip"}, "processors only; ranks of MPI and -threads"},
  };
  return table;
}

}  // namespace

std::string not_supported(const std::string &name) {
  std::string plain = name;
  std::transform(plain.begin(), plain.end(), plain.begin(),
                 [](unsigned char c) { return std::isalnum(c) ? std::tolower(c) : ' '; });
  std::istringstream stream(plain);
  for (std::string word; stream >> word;)
    for (const auto &[words, why] : missing())
      if (std::find(words.begin(), words.end(), word) != words.end())
        return "\"" + word + "\" is not supported: " + why + "; see README.md, \"What it does not do\"";
  return {};
}

}  // namespace eulastic
