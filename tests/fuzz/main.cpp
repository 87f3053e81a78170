// usage: fuzz [CASES [SEED]], or fuzz --lines CASES SEED: prints command lines for run_lines.py.
// Wrong and nearly right input, CASES of it (default 10000), in one process: command lines, options files, position
// lists, initial states, volumes (NRRD, STL, HDF5), checkpoints. Prints how many of each kind were refused and
// accepted, and what was found: a refusal of no line or of several, something written by a run that was refused,
// options that do not survive being written, a case that takes longer than a minute. A crash ends the program and names
// its case.
#include "base/events.hpp"
#include "base/message_keeper.hpp"
#include "fuzz/command_lines.hpp"
#include "fuzz/hdf5_files.hpp"
#include "fuzz/volume_files.hpp"
#include "fuzz/watchdog.hpp"
#include "grid/domain.hpp"
#include "io/checkpoint.hpp"
#include "run/run.hpp"
#include "scene/check_only.hpp"
#include "support/leaks.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

using namespace eulastic;
using namespace eulastic::fuzz;

namespace {

namespace fs = std::filesystem;

struct Outcome {
  bool accepted = false;
  std::string found;  ///< what is wrong with the program; empty = nothing
};

class Fuzzer {
public:
  explicit Fuzzer(const fs::path &room) : room_(room) {}

  PetscErrorCode prepare();
  Outcome command_line(Dice &dice) { return judge(spoiled_line(dice, valid_line(dice))); }
  Outcome options_file(Dice &dice);
  Outcome positions(Dice &dice);
  Outcome initial_state(Dice &dice);
  Outcome nrrd(Dice &dice) { return voxels(dice, put("volume.nrrd", said(nrrd_volume(dice)))); }
  Outcome stl(Dice &dice) { return voxels(dice, put("surface.stl", said(stl_surface(dice)))); }
  Outcome hdf5_volume(Dice &dice);
  Outcome checkpoint(Dice &dice);

private:
  Outcome judge(const Words &words);
  Outcome voxels(Dice &dice, const std::string &file);
  std::string run_it(const ParseResult &parsed, Outcome *outcome);
  static std::string text_of(const fs::path &path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }
  static const std::string &said(const std::string &bytes) {
    present += bytes;
    return bytes;
  }
  /// `bytes` of a good HDF5 file with bits turned, cut, or objects changed.
  fs::path put_damaged(Dice &dice, const char *name, const std::string &bytes) const {
    const bool objects = dice.one_in(3);
    const fs::path file = put(name, objects ? bytes : dice.damage(bytes));
    if (objects) change_objects(dice, file);
    return file;
  }
  fs::path put(const char *name, const std::string &text) const {
    std::ofstream(room_ / name, std::ios::binary) << text;
    return room_ / name;
  }

  fs::path room_;
  std::vector<std::string> cases_;  ///< texts of options/
  std::string volume_;              ///< bytes of a good one
  struct Good {
    Words line;
    std::string checkpoint, snapshot;
  };
  PetscErrorCode make_good(const std::string &line, Good *good) const;
  Good one_, several_;  ///< runs of one body, and of three: bodies in boxes of their own
};

Words words_of(const std::string &line) {
  std::istringstream text(line);
  Words words;
  for (std::string word; text >> word;) words.push_back(word);
  return words;
}

bool one_line(const std::string &message) {
  return !message.empty() && message.find_first_of("\n\r") == std::string::npos && message.size() < 1500;
}

// Runs what was accepted; what PETSc calls an error without a line for the user is found.
std::string Fuzzer::run_it(const ParseResult &parsed, Outcome *outcome) {
  std::string refusal;
  int code = -1;
  const fs::path directory = parsed.config.output.directory;
  fs::remove_all(directory);
  const MessageKeeper kept;
  const PetscErrorCode failed = run(parsed, &code, &refusal);
  if (failed) {
    refusal = kept.text();
    code = failed == PETSC_ERR_USER_INPUT ? exit_usage : exit_failed;
    if (failed != PETSC_ERR_FILE_UNEXPECTED && failed != PETSC_ERR_NOT_CONVERGED && failed != PETSC_ERR_USER_INPUT)
      outcome->found = "internal error " + std::to_string(failed) + ": " + kept.text();
  }
  if (code == exit_fine && !refusal.empty()) outcome->found = "exit code 0 with an error: " + refusal;
  if (code != exit_fine && !one_line(refusal)) outcome->found = "not one line: " + refusal;
  if (code == exit_usage && fs::exists(directory)) outcome->found = "refused, but something was written: " + refusal;
  if (code != exit_usage && !fs::exists(directory / "options.txt") && !failed) outcome->found = "no options.txt";
  for (const auto &entry : fs::exists(directory) ? fs::directory_iterator(directory) : fs::directory_iterator())
    if (entry.path().extension() == ".tmp") outcome->found = "left behind: " + entry.path().string();
  return refusal;
}

Outcome Fuzzer::judge(const Words &words) {
  Outcome outcome;
  Words line = words;
  line.push_back("-output_dir");
  line.push_back(room_ / "run");
  for (const std::string &word : line) present += " '" + word + "'";
  ParseResult parsed = parse(line);
  if (!parsed.message.empty()) return outcome;
  if (!parsed.error.empty()) {
    if (!one_line(parsed.error)) outcome.found = "not one line: " + parsed.error;
    return outcome;
  }
  outcome.accepted = true;
  if (!one_line(Domain::refusal_reason(parsed.config.grid, 1) + ".")) outcome.found = "not one line";
  if (!Domain::refusal_reason(parsed.config.grid, 1).empty()) return outcome;
  if (!parsed.config.check_only) line.push_back("-check_only");  // with it the files of voxels are read and measured
  const ParseResult checked = parse(line);
  if (checked.error.empty())
    (void)check_report(checked.config, 1);
  else if (!one_line(checked.error))
    outcome.found = "not one line: " + checked.error;
  const std::string text = options_text(parsed);
  const ParseResult again = parse({put("options.txt", text)});
  const auto rows = [](const std::string &all) { return all.substr(all.find('\n')); };
  if (!again.error.empty())
    outcome.found = "options.txt is refused: " + again.error;
  else if (rows(options_text(again)) != rows(text))
    outcome.found = "options.txt is another case:\n" + text;
  if (!parsed.config.check_only && small(parsed.config) && outcome.found.empty())
    outcome.accepted = run_it(parsed, &outcome).empty();
  return outcome;
}

Outcome Fuzzer::options_file(Dice &dice) {
  const std::string text = dice.spoil(dice.of(cases_), 6);
  present += text;
  return judge({put("case.opts", text), "-check_only"});
}

Outcome Fuzzer::positions(Dice &dice) {
  std::string text = dice.one_in(2) ? "x,y,z\n" : dice.one_in(2) ? "x,y,z,angle_x,angle_y,angle_z\n" : "";
  const std::string separator(1, ",,; \t"[dice.below(5)]);
  std::size_t n = 1 + dice.below(4);
  if (dice.one_in(4)) text = std::to_string(dice.one_in(4) ? dice.below(9) : n) + "\n" + text;
  if (dice.one_in(8)) text = "\xEF\xBB\xBF# cells\n" + text;
  for (; n > 0; --n) {
    for (int c = 0, columns = dice.one_in(3) ? 6 : 3; c < columns; ++c)
      text += (c ? separator : "") + std::to_string(0.1 * static_cast<double>(dice.below(12)));
    text += dice.one_in(4) ? "\r\n" : "\n";
  }
  if (!dice.one_in(3)) text = dice.spoil(text, 2);
  present += text;
  Words words = words_of(
      "-grid_cells 8,8,8 -time_end 1 -time_steps_max 1 -species cell -cell_shape ellipsoid -cell_semi_axes .2,.1,.1 "
      "-cell_shear_modulus 1 -cell_placement list");
  words.insert(words.end(), {"-cell_positions", put("positions.csv", text)});
  return judge(words);
}

Outcome Fuzzer::initial_state(Dice &dice) {
  const int flat[3] = {8, 7, 1}, deep[3] = {6, 5, 4};
  const bool is_flat = dice.one_in(2);
  fs::path file = room_ / "state.h5";
  const bool snapshot = dice.one_in(3);
  if (snapshot)
    file = put_damaged(dice, "state.h5", one_.snapshot);
  else
    write_state(dice, file, is_flat ? flat : deep);
  const char *cells = snapshot ? "12,10,1" : is_flat ? "8,7,1" : "6,5,4";
  Words words{"-grid_cells",    cells, "-time_end",        "1", "-time_steps_max", "1",
              "-initial_state", file,  "-fluid_viscosity", ".1"};
  if (dice.one_in(2)) words.insert(words.end(), {"-boundary_y", "wall"});
  if (!dice.one_in(4)) words.insert(words.end(), {"-species", "cell", "-cell_shear_modulus", "1"});
  if (dice.one_in(6)) words.insert(words.end(), {"-cell_shape", "sphere", "-cell_radius", ".2"});
  return judge(words);
}

Outcome Fuzzer::hdf5_volume(Dice &dice) {
  const int cells[3] = {8, 7, 6};
  if (dice.one_in(3)) return voxels(dice, put_damaged(dice, "volume.h5", volume_));
  write_state(dice, room_ / "volume.h5", cells);
  return voxels(dice, (room_ / "volume.h5").string() + (dice.one_in(3) ? ":pressure" : ":solid_fraction"));
}

Outcome Fuzzer::voxels(Dice &dice, const std::string &file) {
  Words words = words_of(
      "-time_end 1 -time_steps_max 1 -fluid_viscosity .1 -species cell -cell_shear_modulus 1 -cell_shape voxels");
  words.insert(words.end(), {"-grid_cells", dice.one_in(3) ? "8,7,1" : "8,7,6", "-cell_voxels", file});
  if (dice.one_in(3)) words.insert(words.end(), {"-cell_voxels_spacing", dice.one_in(3) ? "1,1,1" : ".1,.2,.3"});
  if (dice.one_in(3)) words.insert(words.end(), {"-cell_voxels_origin", dice.one_in(3) ? "-.5,0,.7" : ".1,.1,.1"});
  if (dice.one_in(4)) words.insert(words.end(), {"-cell_voxels_invert"});
  return judge(words);
}

Outcome Fuzzer::checkpoint(Dice &dice) {
  const Good &good = dice.one_in(2) ? several_ : one_;
  const fs::path file = put_damaged(dice, "checkpoint.h5", good.checkpoint);
  Words words = good.line;
  words.insert(words.end(), {"-restart", file, "-time_steps_max", "3"});
  return judge(words);
}

PetscErrorCode Fuzzer::make_good(const std::string &line, Good *good) const {
  PetscFunctionBeginUser;
  good->line = words_of(line);
  Words words = good->line;
  const fs::path directory = room_ / "good";
  words.insert(words.end(), {"-time_steps_max", "2", "-checkpoint_interval", "1e-9", "-snapshot_interval", "9",
                             "-output_dir", directory});
  int code = -1;
  std::string refusal;
  fs::remove_all(directory);
  PetscCall(run(parse(words), &code, &refusal));
  PetscCheck(code == 0, PETSC_COMM_SELF, PETSC_ERR_PLIB, "%s", refusal.c_str());
  good->checkpoint = text_of(list_checkpoints(directory).front());
  good->snapshot = text_of(directory / "snapshot_000000.h5");
  PetscCheck(!good->checkpoint.empty() && !good->snapshot.empty(), PETSC_COMM_SELF, PETSC_ERR_PLIB, "no file");
  PetscFunctionReturn(0);
}

PetscErrorCode Fuzzer::prepare() {
  PetscFunctionBeginUser;
  for (const auto &entry : fs::directory_iterator(EULASTIC_OPTIONS_DIR))
    if (entry.path().extension() == ".opts") cases_.push_back(text_of(entry.path()));
  std::sort(cases_.begin(), cases_.end());
  volume_ = text_of(fs::path(EULASTIC_OPTIONS_DIR) / "branched_vessel.h5");
  const std::string line =
      "-grid_cells 12,10,1 -boundary_y wall -boundary_ymax_velocity .4,0,0 -fluid_viscosity .3 -time_end 9 -species "
      "cell "
      "-cell_shape sphere -cell_shear_modulus 1 -cell_radius ";
  PetscCall(make_good(line + ".3", &one_));
  PetscCall(make_good(line + ".12 -cell_placement lattice -cell_count 3,1,1", &several_));
  PetscCheck(several_.checkpoint.find("values_in_boxes") != std::string::npos && !volume_.empty(), PETSC_COMM_SELF,
             PETSC_ERR_PLIB, "no file, or not one of three phases");
  PetscFunctionReturn(0);
}

struct Kind {
  const char *name;
  Outcome (Fuzzer::*run)(Dice &);
  int share;  ///< of 20
  long tried = 0, accepted = 0, found = 0;
};

PetscErrorCode fuzz_all(long cases, unsigned long seed, std::FILE *out, long *found) {
  PetscFunctionBeginUser;
  std::string room = (fs::temp_directory_path() / "eulastic_fuzz_XXXXXX").string();
  PetscCheck(mkdtemp(room.data()), PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "%s", room.c_str());
  Fuzzer fuzzer(room);
  PetscCall(fuzzer.prepare());
  std::vector<Kind> kinds{{"command line", &Fuzzer::command_line, 7},
                          {"options file", &Fuzzer::options_file, 3},
                          {"positions", &Fuzzer::positions, 2},
                          {"initial state", &Fuzzer::initial_state, 2},
                          {"NRRD", &Fuzzer::nrrd, 2},
                          {"STL", &Fuzzer::stl, 1},
                          {"HDF5 volume", &Fuzzer::hdf5_volume, 1},
                          {"checkpoint", &Fuzzer::checkpoint, 2}};
  for (Kind &kind : kinds)
    for (long n = 0; n < cases * kind.share / 20; ++n) {
      Dice dice(seed_of_case(seed, n));
      present =
          std::string("\nfuzz: ") + kind.name + ", seed " + std::to_string(seed) + ", case " + std::to_string(n) + ":";
      watch(true);
      const Outcome outcome = (fuzzer.*kind.run)(dice);
      ++kind.tried;
      kind.accepted += outcome.accepted;
      if (outcome.found.empty()) continue;
      ++kind.found;
      std::fprintf(stderr, "%s\nfuzz: %s\n", present.c_str(), outcome.found.c_str());
    }
  watch(false);
  std::fprintf(out, "%-14s %8s %8s %8s %8s\n", "input", "tried", "refused", "accepted", "found");
  Kind sum{"all", nullptr, 0};
  for (const Kind &kind : kinds) {
    sum.tried += kind.tried, sum.accepted += kind.accepted, sum.found += kind.found;
    std::fprintf(out, "%-14s %8ld %8ld %8ld %8ld\n", kind.name, kind.tried, kind.tried - kind.accepted, kind.accepted,
                 kind.found);
  }
  std::fprintf(out, "%-14s %8ld %8ld %8ld %8ld\n", sum.name, sum.tried, sum.tried - sum.accepted, sum.accepted,
               sum.found);
  *found = sum.found;
  fs::remove_all(room);
  PetscFunctionReturn(0);
}

}  // namespace

int main(int argc, char **argv) {
  if (argc == 4 && !std::strcmp(argv[1], "--lines")) {
    MPI_Init(nullptr, nullptr);
    print_lines(std::atol(argv[2]), std::atol(argv[3]));
    return MPI_Finalize();
  }
  const long cases = argc > 1 ? std::atol(argv[1]) : 10000;
  const unsigned long seed = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 1;
  std::FILE *out = fdopen(dup(1), "w");  // the runs themselves print to nowhere
  if (!out || !std::freopen("/dev/null", "w", stdout)) return 1;
  int none = 1;
  PetscCall(PetscInitialize(&none, &argv, nullptr, nullptr));
  PetscCall(register_events());
  say_case_at_death();
  long found = 0;
  PetscCall(fuzz_all(cases, seed, out, &found));
  if (H5Fget_obj_count(H5F_OBJ_ALL, H5F_OBJ_ALL) > 0) ++found, std::fprintf(stderr, "fuzz: HDF5 objects left open\n");
  test::check_leaks();
  PetscCall(PetscFinalize());
  std::fclose(out);
  return found > 0;
}
