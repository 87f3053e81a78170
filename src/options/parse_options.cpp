#include "options/parse_options.hpp"

#include "base/one_line.hpp"
#include "base/rank_zero.hpp"
#include "io/checksum.hpp"
#include "io/nrrd_header.hpp"
#include "io/option_values.hpp"
#include "io/volume_file.hpp"
#include "options/help_text.hpp"
#include "options/option_rows.hpp"
#include "options/option_source.hpp"
#include "options/option_table.hpp"
#include "options/petsc_options.hpp"
#include "options/unknown_option.hpp"
#include "scene/openings.hpp"
#include "scene/red_cell.hpp"
#include "scene/validate.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <set>

namespace eulastic {
namespace {

constexpr const char *unset = "none";  // the value that makes an option of a lower source not given

// The entry of the highest source that gives an option, or null.
const Entry *last_given(const std::vector<Source> &sources, const std::string &name) {
  const Entry *given = nullptr;
  for (const Source &source : sources)
    for (const Entry &entry : source)
      if (entry.name == name) given = &entry;
  return given && given->value != unset ? given : nullptr;
}

// Names of the species, from the highest source that gives any.
std::string read_species(const std::vector<Source> &sources, Config *config) {
  const Entry *given = last_given(sources, "species");
  if (!given || given->value.empty()) return {};  // the missing value is reported later
  std::vector<std::string> names;
  std::string wrong = read_words(given->value, {}, &names);
  for (const std::string &name : names) {
    const std::string first = lower_case(name.substr(0, name.find('_')));
    if (!std::isalpha(static_cast<unsigned char>(name[0])) ||
        !std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) || c == '_'; }))
      wrong = "\"" + name + "\" is not a name of letters, digits and _ that begins with a letter";
    else if (is_reserved_word(first))
      wrong = "\"" + name + "\" collides with the options -" + first + "...; accepted: another name";
    config->species.emplace_back().name = name;
  }
  return wrong.empty() ? wrong : "-species: " + wrong + given->where;
}

// Pairs of -adhesion, when the species are known.
std::string read_pairs(const std::vector<Source> &sources, Config *config) {
  const Entry *given = last_given(sources, "adhesion");
  if (!given || given->value.empty()) return {};
  const std::string wrong = read_adhesion(given->value, config);
  if (wrong.empty()) return wrong;
  return "-adhesion: " + wrong + "; accepted: a list without spaces of NAME1-NAME2 or NAME-wall, NAME of -species" +
         given->where;
}

// An option that a file gives and whose meaning a higher source has taken.
struct Lost {
  std::string name, only_with, where;
};

class Reader {
public:
  explicit Reader(std::vector<Option> &table) : table_(table) {
    for (Option &option : table) {
      if (!index_.emplace(option.name, &option).second && clash_.empty())
        clash_ = "-species: two species would share the option -" + option.name;
      defaults_.emplace(option.name, option.text ? option.text() : std::string());
    }
  }

  /// Removes options with the value none, and what lower sources say of them.
  void remove_unset(std::vector<Source> *sources) const {
    std::set<std::string> removed;
    for (auto source = sources->rbegin(); source != sources->rend(); ++source) {
      std::set<std::string> here;
      const auto is_unset = [&](const Entry &entry) {
        const auto found = index_.find(entry.name);
        if (found == index_.end() || entry.name == "output_dir") return false;  // a directory may have this name
        const std::string &name = target(*found->second);
        if (entry.value == unset) here.insert(name);
        return entry.value == unset || removed.count(name) > 0;
      };
      source->erase(std::remove_if(source->begin(), source->end(), is_unset), source->end());
      removed.merge(here);
    }
  }

  /// Reads one source over those before it.
  std::string read(const Source &source, bool is_last) {
    std::set<std::string> here;
    for (const Entry &entry : source) {
      if (is_petsc_option(entry.name)) continue;
      const auto found = index_.find(entry.name);
      if (found == index_.end()) return unknown_option(entry.name, table_) + entry.where;
      const Option &option = *found->second;
      const std::string &name = target(option);
      const auto refuse = [&](const std::string &what) {
        return "-" + entry.name + ": " + what + "; accepted: " + option.accepted + entry.where;
      };
      if (!here.insert(name).second)
        return refuse(option.alias_of.empty() ? "given twice" : "given twice, also as -" + name);
      if (entry.value.empty() && !option.bare) return refuse("a value is missing");
      if (!option.read) return refuse("out of place");
      const bool is_file = option.names_file && option.names_file(entry.value);
      const std::string wrong = option.read(entry.value.empty() ? "true" : is_file ? find_input(entry) : entry.value);
      if (!wrong.empty()) {
        const std::string why = option.accepted.rfind("one of ", 0) == 0 ? not_supported(entry.value) : "";
        return refuse(wrong + (why.empty() ? "" : "; " + why));
      }
      given_[name] = {entry.where, false, false};
    }
    for (const std::string &name : here) {
      const Option &option = *index_.at(name);
      given_[name].may_lose = !is_last && applies(option);
      given_[name].says_nothing = !is_last && option.text && option.text() == defaults_.at(name);
    }
    return clash_;
  }

  /// Options that are missing, or that have no meaning beside the others. `lost`: those that had one in their own file.
  std::string check_given(std::vector<Lost> *lost) const {
    for (const Option &option : table_) {
      const auto given = given_.find(option.name);
      if (given != given_.end() && !applies(option)) {
        if (!given->second.may_lose && given->second.says_nothing) continue;
        if (!given->second.may_lose)
          return "-" + option.name + ": applies only with " + option.only_with + given->second.where;
        lost->push_back({option.name, option.only_with, given->second.where});
      }
      if (given == given_.end() && applies(option) && option.required)
        return "-" + option.name + ": must be given; accepted: " + option.accepted;
    }
    return {};
  }
  /// Sets an option that was not given, as if it were.
  void preset(const std::string &name, const std::string &value) {
    if (!given(name)) (void)index_.at(name)->read(value);
    given_.emplace(name, Given{});
  }
  bool given(const std::string &name) const { return given_.count(name) > 0; }

private:
  struct Given {
    std::string where;
    bool says_nothing = false;  ///< a file gives the default, as options.txt of earlier versions does beside any law
    bool may_lose = false;      ///< had a meaning when its source had been read, and is not of the command line
  };
  static bool applies(const Option &option) { return !option.applies || option.applies(); }
  static const std::string &target(const Option &option) {
    return option.alias_of.empty() ? option.name : option.alias_of;
  }

  const std::vector<Option> &table_;
  std::map<std::string, const Option *> index_;
  std::map<std::string, std::string> defaults_;
  std::map<std::string, Given> given_;
  std::string clash_;
};

// PETSc's part of the pressure solver, which means something with one of them only. `had_ksp`: whether that was chosen
// when each source had been read.
std::string check_petsc_entries(const std::vector<Source> &sources, const Config &config,
                                const std::vector<bool> &had_ksp, std::vector<Lost> *lost) {
  const std::string needed = "-pressure_solver ksp";
  for (std::size_t s = 0; s < sources.size(); ++s)
    for (const Entry &entry : sources[s]) {
      if (is_pressure_ksp_option(entry.name) && config.method.pressure != PressureKind::ksp) {
        if (!had_ksp[s] || s + 1 == sources.size())
          return "-" + entry.name + ": applies only with " + needed + entry.where;
        lost->push_back({entry.name, needed, entry.where});
      }
      if (const std::string wrong = check_petsc_value(entry.name, entry.value, config.output.directory); !wrong.empty())
        return wrong + entry.where;
    }
  return {};
}

// Reads all sources into `config`. `lost`: options that are to be removed, after which all is read once more.
std::string read_sources_once(std::vector<Source> *sources, Config *config, std::vector<Lost> *lost) {
  if (std::string wrong = read_species(*sources, config); !wrong.empty()) return wrong;
  if (std::string wrong = read_pairs(*sources, config); !wrong.empty()) return wrong;
  if (const Entry *method = last_given(*sources, "method"))
    (void)read_method(method->value, config);  // what is wrong with it is reported later
  if (const Entry *state = last_given(*sources, "initial_state")) {
    config->initial_state = find_input(*state);
    for (SpeciesSpec &spec : config->species) spec.shape = Shape::state;
  }
  std::vector<Option> table = option_table(*config);
  Reader reader(table);
  reader.remove_unset(sources);
  std::vector<bool> had_ksp;
  for (const Source &source : *sources) {
    if (std::string wrong = reader.read(source, &source == &sources->back()); !wrong.empty()) return wrong;
    had_ksp.push_back(config->method.pressure == PressureKind::ksp);
  }
  for (int d = 0; d < 3; ++d)
    config->grid.boundary[d] = config->boundary.bounded(d) ? Boundary::wall : Boundary::periodic;
  for (const SpeciesSpec &spec : config->species)
    if (spec.law == Law::red_cell)
      for (const auto &[name, value] : red_cell_preset()) reader.preset(spec.name + "_" + name, value);
  // Before the options of a boundary, which would be refused for a kind that they do have.
  if (std::string wrong = check_single_sides(*config); !wrong.empty()) return wrong;
  if (std::string wrong = reader.check_given(lost); !wrong.empty()) return wrong;
  if (std::string wrong = check_petsc_entries(*sources, *config, had_ksp, lost); !wrong.empty()) return wrong;
  for (SpeciesSpec &spec : config->species) {
    spec.centre_given = reader.given(spec.name + "_centre");
    const Real3 &length = config->grid.length;
    if (!spec.centre_given) spec.centre = {length[0] / 2, length[1] / 2, length[2] / 2};
    if (spec.is_membrane() && !reader.given(spec.name + "_gap")) spec.gap = config->grid.longest_spacing();
  }
  return {};
}

// One line for all options that need the same.
void remove_lost(const std::vector<Lost> &lost, std::vector<Source> *sources, std::vector<std::string> *warnings) {
  std::map<std::string, std::vector<std::string>> groups;
  for (const Lost &one : lost) groups[one.only_with].push_back("-" + one.name + one.where);
  for (const auto &[only_with, names] : groups)
    warnings->push_back(join(names, ", ") + ": dropped, as " + (names.size() > 1 ? "they apply" : "it applies") +
                        " only with " + only_with);
  for (Source &source : *sources)
    source.erase(std::remove_if(source.begin(), source.end(),
                                [&](const Entry &entry) {
                                  return std::any_of(lost.begin(), lost.end(),
                                                     [&](const Lost &one) { return one.name == entry.name; });
                                }),
                 source.end());
}

std::string read_sources(std::vector<Source> *sources, Config *config, std::vector<std::string> *warnings) {
  const Config fresh = *config;
  for (std::vector<Lost> lost;; lost.clear()) {
    *config = fresh;
    if (std::string wrong = read_sources_once(sources, config, &lost); !wrong.empty()) return wrong;
    if (lost.empty()) break;
    remove_lost(lost, sources, warnings);
  }
  if (std::string wrong = resolve_openings(config); !wrong.empty()) return wrong;
  if (config->output.series_interval == 0) config->output.series_interval = config->time.end / 200;
  const Method &method = config->method;
  const bool paper = method.interface == InterfaceScheme::weno5 && method.exterior == SolidExterior::identity;
  if (paper || config->species.empty()) config->grid.ghosts = Box::stencil_width;
  return validate(config);
}

// Removes options that count on the command line alone.
void leave_to_command_line(Source *source, std::vector<std::string> *warnings) {
  const auto counts_elsewhere = [&](const Entry &entry) {
    if (entry.name != "output_overwrite") return false;
    bool asked = true;
    (void)read_boolean(entry.value, &asked);
    if (asked) warnings->push_back("-" + entry.name + ": applies only on the command line" + entry.where);
    return true;
  };
  source->erase(std::remove_if(source->begin(), source->end(), counts_elsewhere), source->end());
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
  for (Source &source : sources) leave_to_command_line(&source, &result->warnings);
  sources.push_back(std::move(command_line));
  wrong = read_sources(&sources, &result->config, &result->warnings);
  for (const Source &source : sources)
    for (const Entry &entry : source)
      if (is_petsc_option(entry.name)) result->petsc[entry.name] = entry.value;
  return wrong;
}

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

// The files that a path stands for: itself, without the dataset of FILE:DATASET, and what a detached NRRD header names.
std::vector<std::string> files_of(const std::string &path) {
  VolumeFormat format{};
  std::string file, dataset;
  NrrdHeader header;
  // Whoever loads the file says what is wrong with it.
  if (find_volume(path, &format, &file, &dataset).empty() && format == VolumeFormat::nrrd)
    (void)read_nrrd_header(file, &header);
  if (header.data_file.empty() || header.data_file == file) return {file};
  return {file, header.data_file};
}

// Of all bytes of the files, one after the other.
std::string hash_files(const std::vector<std::string> &files) {
  std::vector<std::uint64_t> words(1 << 16);
  std::uint64_t sum = 0, count = 0;
  for (const std::string &path : files) {
    std::ifstream file(path, std::ios::binary);
    for (std::size_t bytes = 1; bytes > 0; count += words.size()) {
      std::fill(words.begin(), words.end(), 0);
      file.read(reinterpret_cast<char *>(words.data()), static_cast<std::streamsize>(words.size() * sizeof words[0]));
      bytes = static_cast<std::size_t>(file.gcount());
      sum += checksum(words.data(), (bytes + sizeof words[0] - 1) / sizeof words[0], count) + mix_bits(bytes);
    }
  }
  return checksum_text(sum);
}

// All files that the options of `config` name, in the order of the options; rank 0 reads them. Collective.
std::vector<InputFile> hash_input_files(const Config &config) {
  Config copy = config;
  std::vector<InputFile> files;
  for (const Option &option : option_table(copy)) {
    if (!option.names_file || !option.text || (option.applies && !option.applies())) continue;
    const std::string path = option.text();
    if (path.empty() || !option.names_file(path)) continue;
    files.push_back({option.name, path, on_rank_0([&] { return hash_files(files_of(path)); })});
  }
  return files;
}

}  // namespace

ParseResult parse(const std::vector<std::string> &arguments, const std::string &petsc_options) {
  ParseResult result;
  result.petsc_options = petsc_options;
  result.alone = arguments.empty() && petsc_options.empty();
  if (result.alone) result.message = usage_text();
  answer(arguments, &result);
  if (!result.message.empty()) return result;
  if (result.error.empty()) result.error = parse_into(arguments, &result);
  if (result.error.empty()) result.inputs = hash_input_files(result.config);
  if (!result.error.empty()) result.petsc.clear();  // no -log_view of a run that is none
  result.error = one_line(result.error);
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
    text += "-" + name + (value.empty() ? "" : " " + quote_word(value)) + "\n";
  };
  std::string group;
  for (const Option &option : option_table(config)) {
    if (!option.text || option.command_line || (option.applies && !option.applies())) continue;
    const std::string value = option.text();
    if (value.empty()) continue;
    if (option.group != group) text += "\n# " + (group = option.group) + "\n";
    line(option.name, value);
    for (const InputFile &file : result.inputs)
      if (file.option == option.name) text += content_mark + file.content + "\n";
  }
  group.clear();
  for (const auto &[name, value] : result.petsc) {
    if (!is_pressure_ksp_option(name)) continue;
    if (group.empty()) text += "\n# " + (group = "PETSc's part of the pressure solver") + "\n";
    line(name, value);
  }
  return text;
}

}  // namespace eulastic
