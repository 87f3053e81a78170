#include "options/help_text.hpp"

#include "base/one_line.hpp"
#include "io/option_values.hpp"
#include "options/option_table.hpp"
#include "options/petsc_options.hpp"
#include "options/renamed_options.hpp"
#include "options/unknown_option.hpp"

#include <petscsys.h>

#include <algorithm>
#include <cctype>
#include <regex>
#include <set>

namespace eulastic {
namespace {

const char *introduction =
    "Options have PETSc's form, -name value, on the command line or in an options file with lines -name value\n"
    "(# begins a comment, \"...\" encloses a value with blanks). The command line overrides the environment variable\n"
    "PETSC_OPTIONS, which overrides the file; .petscrc is not read. The value none removes an option that the file "
    "sets;\n"
    "an option of the file that no longer applies is dropped with a warning. Lists have commas and no spaces. Where a\n"
    "word such as auto, off or unlimited is accepted instead of a number > 0, the number 0 means the same. SIDE "
    "stands\n"
    "for xmin, xmax, ymin, ymax, zmin or zmax, NAME for a species. Any consistent set of units may be used. Wrong "
    "input\n"
    "ends the program with exit code 2, before anything is written.\n";

// One species stands for all, and one pair of them.
Config example() {
  Config config;
  config.species.resize(1);
  config.species[0].name = "NAME";
  config.adhesion.pairs.resize(1);
  config.adhesion.pairs[0].name = "NAME1-NAME2";
  config.adhesion.pairs[0].second = AdhesionPair::wall;
  return config;
}

std::string default_text(const Option &option) {
  if (option.required) return "required";
  if (!option.default_note.empty()) return option.default_note;
  return option.text ? option.text() : "";
}

std::string remarks(const Option &option) {
  return option.doc + (option.only_with.empty() ? "" : "; only with " + option.only_with);
}

// A cell of a table.
std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, 1, '\\');
  return text;
}

// As troff shows it: a - that can be copied, no escapes, and no line that is taken for a request.
std::string troff(const std::string &text) {
  std::string shown;
  for (const char c : text) {
    const bool at_line = shown.empty() || shown.back() == '\n';
    if (at_line && (c == '.' || c == '\'')) shown += "\\&";
    shown += c == '-' ? "\\-" : c == '\\' ? "\\e" : std::string(1, c);
  }
  return shown;
}

// Those with `word`, of families also those that it may belong to: ksp_type to -pressure_ksp_*.
std::string petsc_names(const std::string &word = {}) {
  std::string text;
  for (const std::string &name : petsc_option_names()) {
    const bool family = name.back() == '_';
    const auto begins = [&](const std::string &option) { return option.compare(0, name.size(), name) == 0; };
    const bool has = name.find(lower_case(word)) != std::string::npos;
    if (has || (family && (begins(word) || begins("pressure_" + word))))
      text += (text.empty() ? "-" : ", -") + name + (family ? "*" : "");
  }
  return text;
}

std::string description(const Option &option) {
  const std::string value = default_text(option);
  return "  -" + option.name + (value.empty() ? "" : " (" + value + ")") + "\n      " + remarks(option) +
         (option.unit.empty() ? "" : " [" + option.unit + "]") + "\n      " + option.accepted + "\n";
}

// SIDE in place of xmin, ..., zmax.
std::string with_any_side(const std::string &text) {
  static const std::regex side("_[xyz](min|max)(?![a-z])"), both(", or -boundary_[xyz] wall");
  return std::regex_replace(std::regex_replace(text, side, "_SIDE"), both, "");
}

// The options whose description has `word`. Options that differ in the boundary only are one, with SIDE for it.
std::vector<Option> options_with(const std::string &word) {
  Config config = example();
  std::vector<Option> found;
  std::set<std::string> names;
  for (Option &option : option_table(config)) {
    if (lower_case(description(option)).find(lower_case(word)) == std::string::npos) continue;
    option.default_note = default_text(option);
    option.required = false;
    option.text = nullptr;  // of a Config that does not live on
    option.name = with_any_side(option.name);
    option.only_with = with_any_side(option.only_with);
    if (names.insert(option.name).second) found.push_back(option);
  }
  return found;
}

}  // namespace

std::string version_text() {
  return "eulastic " EULASTIC_VERSION ", PETSc " + std::to_string(PETSC_VERSION_MAJOR) + "." +
         std::to_string(PETSC_VERSION_MINOR) + "." + std::to_string(PETSC_VERSION_SUBMINOR) + "\n";
}

std::string usage_text() {
  return version_text() + "Soft bodies in incompressible flow on one fixed grid.\n\n" +
         "usage: eulastic [OPTIONS_FILE] [-name value ...]\n\n"
         "  eulastic options/channel_rbc.opts -output_dir output/mine    runs a case, here one of options/\n"
         "  eulastic CASE -check_only                                    validates a case and prints derived numbers\n"
         "  eulastic -help WORD                                          options with this word; -help alone: all\n"
         "  mpiexec -n 4 eulastic CASE                                   on four ranks\n\n"
         "README.md describes a first case of your own.\n";
}

std::string help_text(const std::string &word) {
  std::string text;
  if (word.empty())
    text = version_text() + "Soft bodies in incompressible flow on one fixed grid.\n\n" +
           "usage: eulastic [OPTIONS_FILE] [-name value ...]\n\n" + introduction;
  std::string group;
  for (const Option &option : options_with(word)) {
    if (option.group != group) text += "\n" + (group = option.group) + "\n";
    text += description(option);
    if (option.name.find("SIDE") != std::string::npos) text += "      SIDE: xmin, xmax, ymin, ymax, zmin or zmax\n";
  }
  if (const std::string names = petsc_names(word); !names.empty())
    text += "\nPETSc's own options pass through: " + names + "\n";
  if (const std::string why = word.empty() ? "" : not_supported(word); !why.empty()) text += "\n" + why + "\n";
  return text;
}

std::string help_markdown() {
  std::string text =
      "# Options\n\nThis page is the reference of all options, for users who write or change a case. Generated by "
      "`eulastic -help markdown`; do not edit.\n\n";
  text += "    eulastic [OPTIONS_FILE] [-name value ...]\n\n";
  text += introduction;
  std::string group;
  for (const Option &option : options_with("")) {
    if (option.group != group)
      text += "\n## " + (group = option.group) +
              "\n\n| option | default | meaning | unit | accepted |\n|---|---|---|---|---|\n";
    text += "| `-" + option.name + "` | " + default_text(option) + " | " + cell(remarks(option)) + " | " + option.unit +
            " | " + option.accepted + " |\n";
  }
  text += "\n## PETSc\n\nPETSc's own options pass through: `" + petsc_names() + "`\n";
  text +=
      "\n## Former names\n\nThese names are refused; the message gives the present name.\n\n| former | present "
      "|\n|---|---|\n";
  for (const auto &[former, now] : renamed_options()) text += "| `-" + former + "` | `-" + now + "` |\n";
  return text;
}

std::string man_page() {
  const std::string version = "eulastic " EULASTIC_VERSION;
  std::string text = ".TH EULASTIC 1 \"\" \"" + version + "\" \"User Commands\"\n.nh\n.ad l\n.SH NAME\n" +
                     "eulastic \\- soft bodies in incompressible flow on one fixed grid\n.SH SYNOPSIS\n" +
                     ".B eulastic\n[\\fIOPTIONS_FILE\\fR] [\\fB\\-name\\fR \\fIvalue\\fR ...]\n.br\n" +
                     ".B mpiexec \\-n 4 eulastic\n[\\fIOPTIONS_FILE\\fR] [\\fB\\-name\\fR \\fIvalue\\fR ...]\n" +
                     ".SH DESCRIPTION\n" + troff(introduction) + ".SH OPTIONS\n";
  std::string group;
  for (const Option &option : options_with("")) {
    if (option.group != group) text += ".SS " + troff(group = option.group) + "\n";
    const std::string value = default_text(option);
    text += ".TP\n\\fB" + troff("-" + option.name) + "\\fR" + (value.empty() ? "" : " (" + troff(value) + ")") + "\n" +
            troff(remarks(option) + (option.unit.empty() ? "" : " [" + option.unit + "]")) + "\n.br\n" +
            troff(option.accepted) + "\n";
  }
  return text + ".SS PETSc\nPETSc's own options pass through: " + troff(petsc_names()) + "\n" +
         ".SH EXIT STATUS\n0: the run reached its end. 1: failure. 2: invalid input, nothing was written. 3: numbers "
         "that are not finite, or a guard.\n" +
         ".SH FILES\nFrom the directory of the program: cases in ../share/eulastic/options, scripts in "
         "../share/eulastic/scripts, documentation in ../share/doc/eulastic.\n";
}

}  // namespace eulastic
