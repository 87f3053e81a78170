#include "run/last_word.hpp"

#include "base/one_line.hpp"

#include <cctype>
#include <map>

namespace eulastic {
namespace {

std::string quoted(const std::string &word) {
  bool plain = !word.empty();
  for (unsigned char c : word)
    plain = plain && (std::isalnum(c) || std::string("_-./+:,=@%").find(c) != std::string::npos);
  if (plain) return word;
  std::string text = "'";
  for (char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace

std::string first_word(const Config &config, int ranks) {
  const Int3 &n = config.grid.cells;
  std::string line = print("eulastic %s: %d x %d x %d cells on %d rank%s", EULASTIC_VERSION, n[0], n[1], n[2], ranks,
                           ranks > 1 ? "s" : "");
  if (config.threads > 1) line += " of " + std::to_string(config.threads) + " threads";
  return line + "; results go to " + config.output.directory;
}

std::string last_word(const ParseResult &parsed, const Ending &end) {
  static const std::map<std::string, std::string> words{
      {"time_end", "reached -time_end"},    {"steps", "reached -time_steps_max"},
      {"signal", "stopped by a signal"},    {"wall_limit", "stopped by -stop_after_minutes"},
      {"guard", "stopped by a guard"},      {"nonfinite", "stopped because numbers are not finite"},
      {"output_failed", "could not write"},
  };
  const std::string &directory = parsed.config.output.directory;
  const std::string place = print(" at t = %.9g, step %lld; results: ", end.time, static_cast<long long>(end.step));
  std::string line = "eulastic: " + words.at(end.reason) + place + directory;
  if (end.checkpoint.empty()) return line + "; there is no checkpoint to continue from";
  const bool whole = end.reason == "time_end" || end.reason == "steps";
  const bool wrong = end.reason == "guard" || end.reason == "nonfinite";
  line += whole ? "; to continue: "
                : "; to continue from " + end.checkpoint + (wrong ? ", with the remedy of the error: " : ": ");
  if (end.ranks > 1) line += "mpiexec -n " + std::to_string(end.ranks) + " ";
  line += quoted(parsed.program) + " " + quoted(directory + "/options.txt") + " -restart " + quoted(directory) +
          " -output_dir " + quoted(directory);
  if (end.reason == "time_end") line += " -time_end LATER";
  if (end.reason == "steps") line += " -time_steps_max MORE";
  return line;
}

}  // namespace eulastic
