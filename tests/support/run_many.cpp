// usage: mpiexec -n RANKS run_many PLAN
// Runs many cases in one start of MPI, side by side on parts of the ranks, which saves most of the time of short runs.
// Lines of PLAN, in order, words separated by tabs:
//   run FIRST RANKS NOTHING_SKIPPED NAME WORD...   runs the case of these command-line words on ranks FIRST ... FIRST +
//                                                  RANKS - 1; writes NAME.out, NAME.err and the exit code to NAME.code
//   wait                                           all ranks wait for each other
// A run starts as soon as its ranks have ended what comes before it in PLAN.
#include "base/rank_zero.hpp"
#include "grid/occupied_rows.hpp"
#include "grid/threads.hpp"
#include "run/program.hpp"
#include "support/sleeping_barrier.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

using namespace eulastic;

namespace {

using Words = std::vector<std::string>;

Words split(const std::string &line) {
  Words words;
  std::istringstream text(line);
  for (std::string word; std::getline(text, word, '\t');) words.push_back(word);
  return words;
}

// Sends a file descriptor to a file until it is destroyed.
class Redirect {
public:
  Redirect(std::FILE *stream, const std::string &path) : stream_(stream), descriptor_(fileno(stream)) {
    (void)std::fflush(stream_);
    kept_ = dup(descriptor_);
    const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    (void)dup2(file, descriptor_);
    (void)close(file);
  }
  ~Redirect() {
    (void)std::fflush(stream_);
    (void)dup2(kept_, descriptor_);
    (void)close(kept_);
  }
  Redirect(const Redirect &) = delete;
  Redirect &operator=(const Redirect &) = delete;

private:
  std::FILE *stream_;
  int descriptor_, kept_;
};

// Runs one case on `comm`, of which this rank is part, as the program would.
int run_case(MPI_Comm comm, const Words &words, const std::string &name) {
  const RunOnRanks part(comm);
  const Redirect out(stdout, name + ".out"), err(stderr, name + ".err");
  ParseResult parsed = parse(words);
  Words given = petsc_arguments(parsed.petsc);
  given.insert(given.begin(), "run_many");
  std::vector<char *> pointers;
  for (std::string &word : given) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  int count = static_cast<int>(given.size());
  char **arguments = pointers.data();
  (void)PetscOptionsClear(nullptr);
  (void)PetscOptionsInsert(nullptr, &count, &arguments, nullptr);
  const int code = act(parsed);
  set_threads(1);
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  if (rank == 0) std::ofstream(name + ".code") << code << "\n";
  return code;
}

PetscErrorCode execute(const char *plan) {
  PetscFunctionBeginUser;
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  std::map<std::pair<int, int>, MPI_Comm> parts;  // communicators by first rank and number
  std::ifstream lines(plan);
  PetscCheck(lines, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "%s", plan);
  for (std::string line; std::getline(lines, line);) {
    const Words words = split(line);
    if (words.at(0) == "wait") {
      PetscCallMPI(test::sleeping_barrier(PETSC_COMM_WORLD));
      continue;
    }
    const int first = std::stoi(words.at(1)), ranks = std::stoi(words.at(2));
    if (rank < first || rank >= first + ranks) continue;
    MPI_Comm &comm = parts.emplace(std::pair(first, ranks), MPI_COMM_NULL).first->second;
    if (comm == MPI_COMM_NULL) {
      MPI_Group world, group;
      int range[1][3] = {{first, first + ranks - 1, 1}};
      PetscCallMPI(MPI_Comm_group(PETSC_COMM_WORLD, &world));
      PetscCallMPI(MPI_Group_range_incl(world, 1, range, &group));
      PetscCallMPI(MPI_Comm_create_group(PETSC_COMM_WORLD, group, first, &comm));
    }
    PetscCallMPI(test::sleeping_barrier(comm));
    set_skip_nothing(words.at(3) == "1");
    (void)run_case(comm, {words.begin() + 5, words.end()}, words.at(4));
    set_skip_nothing(false);
  }
  PetscCallMPI(test::sleeping_barrier(PETSC_COMM_WORLD));
  PetscFunctionReturn(0);
}

}  // namespace

int main(int argc, char **argv) {
  unsetenv("PETSC_OPTIONS");
  const char *plan = argc > 1 ? argv[1] : "";
  int count = 1;
  int threads = 0;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &threads)) return 1;
  PetscCall(PetscInitialize(&count, &argv, nullptr, nullptr));
  PetscCall(execute(plan));
  PetscCall(PetscFinalize());
  return MPI_Finalize();
}
