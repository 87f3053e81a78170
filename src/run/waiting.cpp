#include "run/waiting.hpp"

#include "base/rank_zero.hpp"
#include "base/team.hpp"
#include "grid/threads.hpp"

#include <sched.h>
#include <cstdlib>

namespace eulastic {
namespace {

struct Node {
  int ranks = 0;
  int processors = 0;      ///< that any of its ranks may use
  int own_processors = 0;  ///< that this rank may use
};

PetscErrorCode query_node(MPI_Comm comm, Node *node) {
  PetscFunctionBeginUser;
  MPI_Comm on_node;
  PetscCallMPI(MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &on_node));
  cpu_set_t own, all;
  CPU_ZERO(&own);
  if (sched_getaffinity(0, sizeof own, &own) != 0) CPU_SET(0, &own);
  PetscCallMPI(MPI_Allreduce(&own, &all, sizeof own, MPI_BYTE, MPI_BOR, on_node));
  PetscCallMPI(MPI_Comm_size(on_node, &node->ranks));
  PetscCallMPI(MPI_Comm_free(&on_node));
  node->processors = CPU_COUNT(&all);
  node->own_processors = CPU_COUNT(&own);
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode start_threads(int threads, std::string *line, std::string *warning, std::string *refusal) {
  PetscFunctionBeginUser;
  const std::string wanted = on_rank_0([] {
    const char *given = std::getenv("EULASTIC_WAIT");
    return std::string(given ? given : "");
  });
  if (wanted != "" && wanted != "spin" && wanted != "sleep") {
    *refusal = "EULASTIC_WAIT: '" + wanted + "'; accepted: spin, sleep";
    PetscFunctionReturn(0);
  }
  set_threads(threads);
  if (threads == 1) PetscFunctionReturn(0);
  Node node;
  PetscCall(query_node(run_communicator(), &node));
  const bool fit = node.own_processors >= threads && node.processors >= node.ranks * threads;
  const bool spin = wanted == "spin" || (wanted == "" && fit);
  ThreadTeam::team_of_rank().set_waiting(spin ? Waiting::spin : Waiting::sleep);
  *line = std::to_string(node.ranks * threads) + " threads on " + std::to_string(node.processors) +
          " processor(s) of this node " + (spin ? "spin" : "sleep") + " while they wait" +
          (wanted == "" ? "" : ", as EULASTIC_WAIT says");
  if (node.own_processors < threads)
    *warning = "-threads " + std::to_string(threads) + ": this rank may use " + std::to_string(node.own_processors) +
               " processor(s); with Open MPI, mpiexec --map-by slot:PE=" + std::to_string(threads) +
               " gives a rank as many as it has threads";
  PetscFunctionReturn(0);
}

}  // namespace eulastic
