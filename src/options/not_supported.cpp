#include "options/not_supported.hpp"

#include <cctype>
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
      {{"neumann", "dirichlet", "farfield"},
       "a boundary of the box is periodic, wall, symmetry, inflow, pressure or outflow: -boundary_x for both "
       "boundaries "
       "of a direction, -boundary_xmin and -boundary_xmax for each"},
      {{"prescribed", "torque"},
       "bodies are carried by the flow, or are rigid (-NAME_law rigid) and move as -NAME_velocity and "
       "-NAME_angular_velocity prescribe; a force on a rigid body cannot be prescribed"},
      {{"shell", "plate"}, "membranes (-NAME_law membrane) are thin: they resist shear, change of area and bending"},
      {{"marangoni", "surfactant", "wetting"},
       "-NAME_surface_tension is constant for a species, and surfaces meet walls at 90 degrees"},
      {{"poisson", "youngs", "young", "bulk", "compressibility", "compressible", "lame"},
       "fluid and bodies are incompressible; -NAME_shear_modulus is a third of Young's modulus"},
      {{"plastic", "plasticity", "viscoelastic", "fibre", "fiber", "anisotropy", "anisotropic", "active", "damage",
        "ogden", "hookean", "stvk", "yeoh", "fung"},
       "bodies are isotropic and elastic, neo_hookean or mooney_rivlin, beside a viscosity"},
      {{"newtonian", "carreau", "casson", "power law", "powerlaw", "bingham", "herschel", "quemada", "shear thinning",
        "rheology", "turbulence", "turbulent", "les", "rans", "smagorinsky"},
       "the fluid is Newtonian (-fluid_viscosity), a species may have another viscosity (-NAME_viscosity), and every "
       "eddy is resolved"},
      {{"temperature", "heat", "thermal", "concentration", "diffusion", "scalar", "solute", "salt", "charge"},
       "only velocity, pressure and bodies are computed"},
      {{"friction", "repulsion", "lubrication", "aggregation"},
       "bodies in contact are separated by the fluid that the grid resolves between them, and held together by "
       "-adhesion; there is no other contact law"},
      {{"refinement", "refine", "amr", "adaptive", "stretching", "grading", "unstructured"},
       "the grid is uniform; -grid_cells and -grid_length"},
      {{"gpu", "cuda", "hip"}, "the program runs on processors only, with ranks of MPI and -threads"},
  };
  return table;
}

// What there is under another name.
const std::vector<std::pair<Words, std::string>> &called_otherwise() {
  static const std::vector<std::pair<Words, std::string>> table{
      {{"inlet", "inlets"}, "is called inflow here: -boundary_xmin inflow with -boundary_xmin_velocity"},
      {{"outlet", "outlets"},
       "is called outflow here, or pressure where the pressure is given: -boundary_xmax outflow, -boundary_xmax "
       "pressure with -boundary_xmax_pressure"},
      {{"time_integrator"}, "is -method: fast is of second order in time, classic plain Euler"},
      {{"skalak"}, "is a law of membranes: -NAME_law membrane with -NAME_membrane_law skalak"},
  };
  return table;
}

// The first of its words that `text`, lower-case words with a blank around each, has; or nothing.
std::string find_word(const std::string &text, const Words &words) {
  for (const std::string &word : words)
    if (text.find(" " + word + " ") != std::string::npos) return word;
  return {};
}

}  // namespace

std::string not_supported(const std::string &name) {
  std::string text = " ";
  for (const unsigned char c : name) text += std::isalnum(c) ? static_cast<char>(std::tolower(c)) : ' ';
  text += ' ';
  for (const auto &[words, where] : called_otherwise())
    if (const std::string word = find_word(text, words); !word.empty()) return '"' + word + "\" " + where;
  for (const auto &[words, why] : missing())
    if (const std::string word = find_word(text, words); !word.empty())
      return '"' + word + "\" is not supported: " + why + "; see README.md, \"What it does not do\"";
  return {};
}

}  // namespace eulastic
