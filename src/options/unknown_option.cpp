#include "options/unknown_option.hpp"

#include "base/one_line.hpp"
#include "io/option_values.hpp"
#include "options/petsc_options.hpp"
#include "options/renamed_options.hpp"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <sstream>
#include <utility>
#include <vector>

namespace eulastic {
namespace {

// Levenshtein.
std::size_t edit_distance(const std::string &a, const std::string &b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j + 1] + 1, row[j] + 1, replaced});
    }
  }
  return row.back();
}

// end_time has the words of time_end.
std::string sorted_words(const std::string &name) {
  std::istringstream stream(name);
  std::vector<std::string> words;
  for (std::string word; std::getline(stream, word, '_');) words.push_back(word);
  std::sort(words.begin(), words.end());
  return join(words, "_");
}

// A part of a name counts as one slip: viscosity is fluid_viscosity.
std::size_t distance(const std::string &typed, const std::string &known) {
  if (("_" + known + "_").find("_" + typed + "_") != std::string::npos) return 1;
  return std::min(edit_distance(typed, known), edit_distance(sorted_words(typed), sorted_words(known)));
}

// "cell" if `name` is an option of species and -species does not name a cell.
std::string missing_species(const std::string &name) {
  for (std::size_t end = name.find('_'); end != std::string::npos; end = name.find('_', end + 1)) {
    const std::string species = name.substr(0, end);
    if (species.empty() || is_reserved_word(species.substr(0, species.find('_')))) continue;
    Config config;
    config.species.resize(1);
    config.species[0].name = species;
    for (const Option &option : option_table(config))
      if (option.name == name) return species;
  }
  return {};
}

}  // namespace

std::string unknown_option(const std::string &name, const std::vector<Option> &table) {
  const std::string start = "unknown option -" + name, end = "; see -help";
  if (is_petsc_option("pressure_" + name)) return start + "; accepted with -pressure_solver ksp: -pressure_" + name;
  const std::string named = name.substr(0, name.find('=')).substr(name[0] == '-'), plain = lower_case(named);
  if (const std::string now = present_name(named); !now.empty())
    return start + ": it is now called -" + now + "; docs/options.md lists all former names";
  const Option *nearest = nullptr;
  std::size_t least = plain.size() / 2 + 1;  // further away it is another word
  for (const Option &option : table)
    if (const std::size_t d = distance(plain, option.name); d < least) least = d, nearest = &option;
  if (nearest && least <= 2) return start + "; nearest known: -" + nearest->name + " (" + nearest->accepted + ")" + end;
  if (const std::string why = not_supported(plain); !why.empty()) return start + ": " + why;
  if (const std::string species = missing_species(name); !species.empty())
    return start + ": -species does not list " + species + end;
  for (const std::string &petsc : petsc_option_names())
    if (petsc.back() != '_' && edit_distance(plain, petsc) <= 2) return start + "; nearest known: -" + petsc + end;
  if (nearest) return start + "; nearest known: -" + nearest->name + " (" + nearest->accepted + ")" + end;
  return start + end;
}

namespace {

using Words = std::vector<std::string>;

// Features, by words that ask for them, and what to use instead.
struct Feature {
  Words words;
  std::string answer;
};

const std::vector<Feature> called_otherwise{
    {{"inlet", "inlets"}, "is called inflow here: -boundary_xmin inflow with -boundary_xmin_velocity"},
    {{"outlet", "outlets"},
     "is called outflow here, or pressure where the pressure is given: -boundary_xmax outflow, -boundary_xmax "
     "pressure with -boundary_xmax_pressure"},
    {{"time_integrator"}, "is called -method here: fast is of second order in time, classic is explicit Euler"},
    {{"skalak"}, "is a law of membranes: -NAME_law membrane with -NAME_membrane_law skalak"},
};

const std::vector<Feature> missing{
    {{"density"}, "bodies have the density of the fluid: -fluid_density sets both"},
    {{"buoyancy", "gravity", "sedimentation"},
     "bodies are as dense as the fluid, so that gravity moves nothing; -body_force drives both, -NAME_body_force one "
     "species alone"},
    {{"neumann", "dirichlet", "farfield"},
     "a boundary of the box is periodic, wall, symmetry, inflow, pressure or outflow: -boundary_x for both "
     "boundaries "
     "of a direction, -boundary_xmin and -boundary_xmax for each"},
    {{"prescribed", "torque"},
     "bodies are carried by the flow, or are rigid (-NAME_law rigid) and move as -NAME_velocity and "
     "-NAME_angular_velocity prescribe; a force or torque on a rigid body cannot be prescribed"},
    {{"shell", "plate"},
     "bodies may have a thin membrane (-NAME_law membrane), which resists shear, area dilation and bending"},
    {{"marangoni", "surfactant", "wetting"},
     "-NAME_surface_tension is constant for a species, and surfaces meet walls at 90 degrees"},
    {{"poisson", "youngs", "young", "bulk", "compressibility", "compressible", "lame"},
     "fluid and bodies are incompressible; -NAME_shear_modulus is a third of Young's modulus"},
    {{"plastic", "plasticity", "viscoelastic", "fibre", "fiber", "anisotropy", "anisotropic", "active", "damage",
      "ogden", "hookean", "stvk", "yeoh", "fung"},
     "bodies are isotropic and elastic (-NAME_law neo_hookean or mooney_rivlin), with a viscosity (-NAME_viscosity)"},
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
    {{"gpu", "cuda", "hip"}, "the program runs on CPUs only, with MPI ranks and -threads"},
};

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
  for (const auto &[words, where] : called_otherwise)
    if (const std::string word = find_word(text, words); !word.empty()) return '"' + word + "\" " + where;
  for (const auto &[words, why] : missing)
    if (const std::string word = find_word(text, words); !word.empty())
      return '"' + word + "\" is not supported: " + why + "; see README.md, \"What it does not do\"";
  return {};
}

}  // namespace eulastic
