#include "fuzz/command_lines.hpp"
#include "options/parse_options.hpp"

#include <algorithm>
#include <cstdio>

namespace eulastic::fuzz {

bool small(const Config &config) {
  double cells = 1, bodies = 0;
  for (int n : config.grid.cells) cells *= n;
  for (const auto &places : config.places) bodies += double(places.count);
  const double rows = config.time.end / config.output.series_interval;
  return cells <= 4096 && bodies <= 100 && config.time.steps_max >= 1 && config.time.steps_max <= 3 && rows < 1e6;
}

void print_lines(long cases, unsigned long seed) {
  const auto print = [](const std::string &word) { (void)std::fwrite(word.c_str(), 1, word.size() + 1, stdout); };
  for (long n = 0; n < cases; ++n) {
    Dice dice(seed_of_case(seed, n));
    Words words = spoiled_line(dice, valid_line(dice));
    for (std::string &word : words) word = word.c_str();  // no argument holds a 0
    words.insert(words.end(), {"-output_dir", "run"});
    const ParseResult parsed = parse(words);
    const bool grid = parsed.error.empty() && parsed.message.empty();
    const std::string error = grid ? Domain::refusal_reason(parsed.config.grid, 1) : parsed.error;
    print(!error.empty()                                      ? error
          : !parsed.message.empty()                           ? "message"
          : !parsed.config.check_only && small(parsed.config) ? "run"
                                                              : "check");
    print(std::to_string(words.size()));
    for (const std::string &word : words) print(word);
  }
}

}  // namespace eulastic::fuzz
