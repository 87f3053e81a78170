#include "fuzz/command_lines.hpp"

#include "options/option_table.hpp"
#include "options/petsc_options.hpp"

#include <algorithm>
#include <sstream>

namespace eulastic::fuzz {
namespace {

Words split(const std::string &line) {
  std::istringstream stream(line);
  Words words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

const Words bodies{"-cell_shape sphere -cell_radius .3",
                   "-cell_shape ellipsoid -cell_semi_axes .3,.2,.25 -cell_orientation 0,0,30",
                   "-cell_shape biconcave -cell_diameter .7",
                   "-cell_shape cylinder -cell_radius .25 -cell_axis z",
                   "-cell_shape slab -cell_interval 0,.3 -cell_axis y",
                   "-cell_shape sphere -cell_radius .2 -cell_placement lattice -cell_count 2,1,1",
                   "-cell_shape sphere -cell_radius .1 -cell_placement random -cell_count 3",
                   "-cell_shape tube -cell_radius .3 -cell_axis x"};
const Words scenes{"-grid_cells 8,8,8", "-grid_cells 12,9,1", "-grid_cells 8,8,1 -boundary_y wall",
                   "-grid_cells 6,7,8 -boundary_y wall -boundary_z wall -boundary_ymax_velocity 1,0,0 "
                   "-boundary_ymax_angular_frequency 2",
                   "-grid_cells 9,8,1 -boundary_x wall -boundary_y wall -boundary_xmin_velocity 0,1,0"};
const Words methods{"",
                    "-method classic",
                    "-method classic -pressure_solver smac",
                    "-pressure_solver smac",
                    "-pressure_solver ksp",
                    "-interface_scheme weno5",
                    "-viscous_scheme explicit -solid_exterior identity"};

const Words numbers{"0",
                    "1",
                    "-1",
                    "2",
                    "3",
                    "0.5",
                    ".1",
                    "1e-3",
                    "1e3",
                    "1e6",
                    "1e9",
                    "1e300",
                    "-1e300",
                    "1e-300",
                    "1e308",
                    "1.8e308",
                    "4.9e-324",
                    "2147483647",
                    "2147483648",
                    "-2147483649",
                    "4294967297",
                    "9223372036854775807",
                    "9223372036854775808",
                    "1e19",
                    "nan",
                    "-nan",
                    "inf",
                    "-inf",
                    "1x",
                    "0x10",
                    "1e",
                    "--1",
                    "+1",
                    ".",
                    "-",
                    "1d0",
                    "00012",
                    "1_000"};

const Words texts{"x",   "output", "a/b", "/", ".", "/dev/null", std::string(300, 'a'), std::string(5000, 'b'),
                  "a b", "~"};
const Words usual{"0", "1", "2", "3", "5", ".1", ".2", ".3", ".5", ".01", "1e-3", "8", "12"};

// Numbers, or the choices that the option itself names, or neither.
std::string value_of(Dice &dice, const Option &option) {
  if (dice.one_in(option.accepted == "a path" ? 2 : 30)) return dice.of(texts);
  if (dice.one_in(12)) return dice.spoil(option.text ? option.text() : "x");
  if (option.text && dice.one_in(6)) return option.text();
  for (const char *lead : {"one of ", "a list without spaces of "})
    if (option.accepted.rfind(lead, 0) == 0 && !dice.one_in(8)) {
      std::string choices = option.accepted.substr(std::string(lead).size());
      std::replace(choices.begin(), choices.end(), ',', ' ');
      const Words all = split(choices);
      return dice.one_in(5) ? dice.of(all) + "," + dice.of(all) : dice.of(all);
    }
  const Words &pool = dice.one_in(2) ? numbers : usual;
  std::string value = dice.of(pool);
  const bool several = option.accepted.find("numbers") != std::string::npos ||
                       option.accepted.find("integers") != std::string::npos ||
                       option.accepted.find("points") != std::string::npos;
  for (std::size_t n = several != dice.one_in(10) ? 2 + dice.one_in(20) : 0; n > 0; --n)
    value += (dice.one_in(30) ? ":" : dice.one_in(30) ? ",," : ",") + dice.of(dice.one_in(9) ? numbers : pool);
  return value;
}

// A word pair -name value of a random row; the rows are those of species "cell".
void add_option(Dice &dice, Words &words) {
  static Config config = [] {
    Config with_species;
    with_species.species.resize(1);
    with_species.species[0].name = "cell";
    return with_species;
  }();
  static const std::vector<Option> table = option_table(config);
  const Option &option = dice.of(table);
  if (option.name == "output_dir" || option.name == "help" || option.name == "version") return;
  std::string name = dice.one_in(40) ? dice.of(petsc_option_names()) + "type" : option.name;
  if (dice.one_in(40)) name = dice.spoil(name, 1);
  const auto there = std::find(words.begin(), words.end(), "-" + name);
  if (there != words.end() && !dice.one_in(20)) {
    if (there + 1 != words.end()) there[1] = value_of(dice, option);
    return;
  }
  words.push_back("-" + name);
  if (!(option.bare && dice.one_in(2)) && !dice.one_in(40)) words.push_back(value_of(dice, option));
}

}  // namespace

Words valid_line(Dice &dice) {
  std::string line = dice.of(scenes) + " -time_end 1 -time_steps_max 2 -fluid_viscosity .1 " + dice.of(methods);
  if (!dice.one_in(4)) line += " -species cell -cell_shear_modulus 1 " + dice.of(bodies);
  if (dice.one_in(3)) line += " -body_force .1,0,0";
  return split(line);
}

Words spoiled_line(Dice &dice, Words words) {
  for (std::size_t n = 1 + dice.below(3); n > 0; --n) {
    if (words.empty() || !dice.one_in(8)) {
      add_option(dice, words);
      continue;
    }
    const std::size_t at = dice.below(words.size());
    switch (dice.below(4)) {
      case 0:
        words.erase(words.begin() + static_cast<long>(at));
        break;
      case 1:
        words.push_back(words[at]);
        break;
      case 2:
        std::swap(words[at], words[dice.below(words.size())]);
        break;
      default:
        words[at] = dice.spoil(words[at], 1);
    }
  }
  return words;
}

}  // namespace eulastic::fuzz
