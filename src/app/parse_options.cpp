#include "app/parse_options.hpp"

#include "app/help_text.hpp"
#include "app/not_supported.hpp"
#include "app/openings.hpp"
#include "app/option_source.hpp"
#include "app/option_table.hpp"
#include "app/option_values.hpp"
#include "app/petsc_options.hpp"
#include "app/red_cell.hpp"
#include "app/unknown_option.hpp"
#include "app/validate.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

namespace eulastic {
namespace {

// What the highest source says of an option, or null.
const Entry *last_given(const std::vector<Source> &sources, const std::string &name) {
  const Entry *given = nullptr;
  for (const Source &source : sources)
    for (const Entry &entry : source)
      if (entry.name == name) given = &entry;
  return given;
}

// Names of the species, from the highest source that gives any.
std::string read_species(const std::vector<Source> &sources, Config *config) {
  const Entry *given = last_given(sources, "species");
  if (!given || given->value.empty()) return {};  // the missing value is reported later
  std::vector<std::string> names;
  std::string wrong = read_words(given->value, {}, &names);
  for (const std::string &name : names) {
    std::string first = name.substr(0, name.find('_'));
    std::transform(first.begin(), first.end(), first.begin(), [](unsigned char c) { return std::tolower(c); });
    if (!std::isalpha(static_cast<unsigned char>(name[0])) ||
        !std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) || c == '_'; }))
      wrong = "\"" + name + "\" is not a name of letters, digits and _ that begins with a letter";
    else if (is_reserved_word(first))
      wrong = "\"" + name + "\" collides with the options -" + first + "...; accepted: another name";
    config->species.emplace_back().name = name;
  }
  return wrong.empty() ? wrong : "-species: " + wrong + given->where;
}

class Reader {
public:
  explicit Reader(std::vector<Option> &table) : table_(table) {
    for (Option &option : table) {
      if (!index_.emplace(option.name, &option).second && clash_.empty())
        clash_ = "-species: two species would share the option -" + option.name;
    }
  }

  /// Reads one source over what is there.
  std::string read(const Source &source) {
    std::set<std::string> here;
    for (const Entry &entry : source) {
      if (is_petsc_option(entry.name)) continue;
      const auto found = index_.find(entry.name);
      if (found == index_.end()) return unknown_option(entry.name, table_) + entry.where;
      const Option &option = *found->second;
      const std::string &name = option.alias_of.empty() ? option.name : option.alias_of;
      const auto refuse = [&](const std::string &what) {
        return "-" + entry.name + ": " + what + "; accepted: " + option.accepted + entry.where;
      };
      if (!here.insert(name).second)
        return refuse(option.alias_of.empty() ? "given twice" : "given twice, also as -" + name);
      if (entry.value.empty() && !option.bare) return refuse("a value is missing");
      if (!option.read) return refuse("out of place");
      const std::string wrong = option.read(entry.value.empty() ? "true"
                                            : option.is_input   ? find_input(entry)
                                                                : entry.value);
      if (!wrong.empty()) {
        const std::string why = option.accepted.rfind("one of ", 0) == 0 ? not_supported(entry.value) : "";
        return refuse(wrong + (why.empty() ? "" : "; " + why));
      }
      where_[name] = entry.where;
    }
    return clash_;
  }

  /// Options that are missing or have no meaning beside the others.
  std::string check_given() const {
    for (const Option &option : table_) {
      const bool applies = !option.applies || option.applies();
      const auto given = where_.find(option.name);
      if (given != where_.end() && !applies)
        return "-" + option.name + ": has a meaning only with " + option.only_with + given->second;
      if (given == where_.end() && applies && option.required)
        return "-" + option.name + ": must be given; accepted: " + option.accepted;
    }
    return {};
  }
  /// As if it were given, where it is not.
  void preset(const std::string &name, const std::string &value) {
    if (!given(name)) (void)index_.at(name)->read(value);
    where_.emplace(name, "");
  }
  bool given(const std::string &name) const { return where_.count(name) > 0; }

private:
  const std::vector<Option> &table_;
  std::map<std::string, const Option *> index_;
  std::map<std::string, std::string> where_;  ///< of what was given
  std::string clash_;
};

std::string read_sources(const std::vector<Source> &sources, Config *config) {
  if (std::string wrong = read_species(sources, config); !wrong.empty()) return wrong;
  if (const Entry *method = last_given(sources, "method"))
    (void)read_method(method->value, config);  // what is wrong with it is reported later
  if (const Entry *state = last_given(sources, "initial_state")) {
    config->initial_state = find_input(*state);
    for (SpeciesSpec &spec : config->species) spec.shape = Shape::state;
  }
  std::vector<Option> table = option_table(*config);
  Reader reader(table);
  for (const Source &source : sources)
    if (std::string wrong = reader.read(source); !wrong.empty()) return wrong;
  for (int d = 0; d < 3; ++d)
    config->grid.boundary[d] = config->boundary.bounded(d) ? Boundary::wall : Boundary::periodic;
  for (const SpeciesSpec &spec : config->species)
    if (spec.law == Law::red_cell)
      for (const auto &[name, value] : red_cell_preset()) reader.preset(spec.name + "_" + name, value);
  if (std::string wrong = reader.check_given(); !wrong.empty()) return wrong;
  if (std::string wrong = resolve_openings(config); !wrong.empty()) return wrong;
  for (const Source &source : sources)
    for (const Entry &entry : source) {
      if (is_pressure_ksp_option(entry.name) && config->method.pressure != PressureKind::ksp)
        return "-" + entry.name + ": has a meaning only with -pressure_solver ksp" + entry.where;
      if (const std::string wrong = check_petsc_value(entry.name, entry.value); !wrong.empty())
        return wrong + entry.where;
    }
  for (SpeciesSpec &spec : config->species) {
    spec.centre_given = reader.given(spec.name + "_centre");
    const Real3 &length = config->grid.length;
    if (!spec.centre_given) spec.centre = {length[0] / 2, length[1] / 2, length[2] / 2};
  }
  if (config->output.series_interval == 0) config->output.series_interval = config->time.end / 200;
  const Method &method = config->method;
  const bool paper = method.interface == InterfaceScheme::weno5 && method.exterior == SolidExterior::identity;
  if (paper || config->species.empty()) config->grid.ghosts = Grid::stencil_width;
  return validate(config);
}

std::string parse_into(const std::vector<std::string> &arguments, ParseResult *result) {
  std::vector<Source> sources;  // files, environment, command line: the last wins
  Source environment, command_line;
  std::string file;
  if (std::string wrong = read_words_as_entries(arguments, "", &command_line, &file); !wrong.empty()) return wrong;
  if (!file.empty())
    if (std::string wrong = read_options_file(file, &sources); !wrong.empty()) return wrong;
  std::vector<std::string> words;
  std::string wrong = split_words(result->petsc_options, &words);
  if (wrong.empty()) wrong = read_words_as_entries(words, " (in PETSC_OPTIONS)", &environment, nullptr);
  if (!wrong.empty()) return wrong;
  sources.push_back(std::move(environment));
  sources.push_back(std::move(command_line));

  for (const Source &source : sources)
    for (const Entry &entry : source)
      if (is_petsc_option(entry.name)) {
        result->petsc_arguments.push_back("-" + entry.name);
        if (!entry.value.empty()) result->petsc_arguments.push_back(entry.value);
      }
  return read_sources(sources, &result->config);
}

}  // namespace

namespace {

// What -help, -h, --help and -version ask for.
void answer(const std::vector<std::string> &arguments, ParseResult *result) {
  for (std::size_t a = 0; a < arguments.size(); ++a) {
    if (arguments[a] == "-h" || arguments[a] == "--help") result->message = usage_text();
    if (arguments[a] == "-version") result->message = version_text();
    if (arguments[a] == "-help") {
      std::string word = a + 1 < arguments.size() ? arguments[a + 1] : "";
      if (word[0] == '-') word.erase(0, word.find_first_not_of('-'));
      result->message = word == "markdown" ? help_markdown() : word == "man" ? man_page() : help_text(word);
      if (result->message.empty()) result->error = "-help: no option has \"" + word + "\" in its name, text or values";
    }
    if (!result->message.empty() || !result->error.empty()) return;
  }
}

}  // namespace

ParseResult parse(const std::vector<std::string> &arguments, const std::string &petsc_options) {
  ParseResult result;
  result.petsc_options = petsc_options;
  result.petsc_arguments = {"-skip_petscrc"};
  result.alone = arguments.empty() && petsc_options.empty();
  if (result.alone) result.message = usage_text();
  answer(arguments, &result);
  if (!result.message.empty()) return result;
  if (result.error.empty()) result.error = parse_into(arguments, &result);
  if (!result.error.empty()) result.petsc_arguments.resize(1);  // no -log_view of a run that is none
  constexpr std::size_t longest = 1000;                         // what was typed may be longer than anybody reads
  if (const std::size_t length = result.error.size(); length > longest)
    result.error.replace(longest / 2, length - longest, " ... ");
  for (char &c : result.error)
    if (std::iscntrl(static_cast<unsigned char>(c))) c = '?';  // one line, whatever was typed
  return result;
}

std::string options_text(const ParseResult &result) {
  Config config = result.config;
  std::string text = std::string("# ") + version_text();
  if (!result.petsc_options.empty()) {
    text += "# PETSC_OPTIONS: ";
    for (char c : result.petsc_options) text += std::iscntrl(static_cast<unsigned char>(c)) ? ' ' : c;
    text += "\n";
  }
  const auto line = [&](const std::string &name, const std::string &value) {
    const bool quotes = value.find_first_of(" #") != std::string::npos;
    text += "-" + name + (value.empty() ? "" : quotes ? " \"" + value + '"' : " " + value) + "\n";
  };
  std::string group;
  for (const Option &option : option_table(config)) {
    if (!option.text || (option.applies && !option.applies())) continue;
    const std::string value = option.text();
    if (value.empty()) continue;
    if (option.group != group) text += "\n# " + (group = option.group) + "\n";
    line(option.name, value);
  }
  group.clear();
  for (const auto &[name, value] : petsc_option_values(result.petsc_arguments)) {
    if (!is_pressure_ksp_option(name)) continue;
    if (group.empty()) text += "\n# " + (group = "PETSc's part of the pressure solver") + "\n";
    line(name, value);
  }
  return text;
}

}  // namespace eulastic
