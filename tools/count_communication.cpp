// Preloaded by scripts/count_communication: what every rank sends, and its collectives, whoever calls MPI. At
// MPI_Finalize each rank writes $EULASTIC_COUNT/RANK.csv with the columns
//   stage, verb    of -log_view, at the call: the innermost verb that is no exchange (PETSc 3.18 and 3.19; else empty)
//   kind           send, exchange, or the name of a collective
//   partner        send: the other rank of MPI_COMM_WORLD; exchange: 0; else ranks of the communicator
//   calls, bytes, largest, seconds
// Bytes are of data: of a send, or the most that a rank gives to or gets from a collective. Persistent sends count when
// they start, neighbourhood collectives as one send to each neighbour. An exchange is all that a rank begins to send to
// others or to receive from them until it has waited for messages, by MPI_Wait and its kin or a row of MPI_Recv: what
// is under way together counts once, for the verb that began it. Seconds are those inside of collectives, waiting for
// other ranks included, not of sends. One-sided communication is not seen.
#define PETSC_HAVE_BROKEN_RECURSIVE_MACRO  // else PETSc counts calls by macros with the names of MPI's functions
#include <mpi.h>
#include <petscsys.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace {

using Key = std::tuple<std::string, std::string, std::string, int>;
struct Sum {
  long calls = 0, bytes = 0, largest = 0;
  double seconds = 0;
};
std::map<Key, Sum> sums;

struct Message {
  int to;
  long bytes;
};
std::map<MPI_Request, Message> persistent;
std::set<MPI_Request> persistent_receives;
enum class Exchange { none, begun, receiving } exchange = Exchange::none;

std::vector<std::string> verbs;  // under way

#if defined(PETSC_USE_LOG) && PETSC_VERSION_LT(3, 20, 0)
const char *event_name(PetscLogEvent event) { return petsc_stageLog->eventLog->eventInfo[event].name; }

// Not the stages, which are events as well, and not what every verb does.
bool is_verb(const char *name) {
  for (const char *other : {"EulExchange", "EulWait", "EulSetup", "EulStep", "EulOutput"})
    if (!std::strcmp(name, other)) return false;
  return !std::strncmp(name, "Eul", 3);
}

PetscErrorCode begin(PetscLogEvent event, int, PetscObject, PetscObject, PetscObject, PetscObject) {
  if (is_verb(event_name(event))) verbs.emplace_back(event_name(event));
  return 0;
}

PetscErrorCode end(PetscLogEvent event, int, PetscObject, PetscObject, PetscObject, PetscObject) {
  if (is_verb(event_name(event)) && !verbs.empty()) verbs.pop_back();
  return 0;
}

std::string stage() {
  if (!petsc_stageLog || petsc_stageLog->curStage < 0) return {};
  return petsc_stageLog->stageInfo[petsc_stageLog->curStage].name;
}

void watch_verbs() {
  PetscLogPLB = begin;
  PetscLogPLE = end;
}
#else
std::string stage() { return {}; }
void watch_verbs() {}
#endif

__attribute__((constructor)) void set() {
  if (std::getenv("EULASTIC_COUNT")) watch_verbs();
}

Sum &add(const char *kind, int partner, long bytes) {
  Sum &sum = sums[{stage(), verbs.empty() ? "" : verbs.back(), kind, partner}];
  ++sum.calls;
  sum.bytes += bytes;
  sum.largest = std::max(sum.largest, bytes);
  return sum;
}

long size_of(long count, MPI_Datatype type) {
  int size = 0;
  PMPI_Type_size(type, &size);
  return count * size;
}

int ranks_of(MPI_Comm comm) {
  int ranks = 0;
  PMPI_Comm_size(comm, &ranks);
  return ranks;
}

int rank_of(MPI_Comm comm) {
  int rank = 0;
  PMPI_Comm_rank(comm, &rank);
  return rank;
}

int in_world(int rank, MPI_Comm comm) {
  MPI_Group from, world;
  int there = MPI_UNDEFINED;
  PMPI_Comm_group(comm, &from);
  PMPI_Comm_group(MPI_COMM_WORLD, &world);
  PMPI_Group_translate_ranks(from, 1, &rank, world, &there);
  PMPI_Group_free(&from);
  PMPI_Group_free(&world);
  return there;
}

void begins_exchange() {
  if (exchange != Exchange::begun) add("exchange", 0, 0);
  exchange = Exchange::begun;
}

void has_waited() { exchange = Exchange::none; }

// A rank's messages to itself do not travel.
bool travels(int other, MPI_Comm comm) { return other != MPI_PROC_NULL && other != rank_of(comm); }

void sends(int to, long count, MPI_Datatype type, MPI_Comm comm) {
  if (!travels(to, comm)) return;
  begins_exchange();
  add("send", in_world(to, comm), size_of(count, type));
}

void receives(int from, MPI_Comm comm) {
  if (travels(from, comm)) begins_exchange();
}

void waits_to_receive(int from, MPI_Comm comm) {
  if (!travels(from, comm)) return;
  if (exchange == Exchange::none) begins_exchange();
  exchange = Exchange::receiving;
}

void starts(MPI_Request request) {
  const auto found = persistent.find(request);
  if (found != persistent.end() || persistent_receives.count(request) > 0) begins_exchange();
  if (found != persistent.end()) add("send", found->second.to, found->second.bytes);
}

void is_persistent(int to, long count, MPI_Datatype type, MPI_Comm comm, MPI_Request request) {
  if (travels(to, comm)) persistent[request] = {in_world(to, comm), size_of(count, type)};
}

// From construction to destruction.
class Collective {
public:
  Collective(const char *kind, long bytes, MPI_Comm comm) : begin_(PMPI_Wtime()) {
    if (ranks_of(comm) > 1) sum_ = &add(kind, ranks_of(comm), bytes);
  }
  ~Collective() {
    if (sum_) sum_->seconds += PMPI_Wtime() - begin_;
  }
  Collective(const Collective &) = delete;
  Collective &operator=(const Collective &) = delete;

private:
  double begin_;
  Sum *sum_ = nullptr;
};

long total(const int *counts, MPI_Comm comm) { return std::accumulate(counts, counts + ranks_of(comm), 0L); }

void to_neighbours(const int *counts, MPI_Datatype type, MPI_Comm comm) {
  int in = 0, out = 0, weighted = 0;
  PMPI_Dist_graph_neighbors_count(comm, &in, &out, &weighted);
  std::vector<int> from(in), to(out), from_weights(in), to_weights(out);
  PMPI_Dist_graph_neighbors(comm, in, from.data(), from_weights.data(), out, to.data(), to_weights.data());
  for (int n = 0; n < out; ++n) sends(to[n], counts[n], type, comm);
}

void write() {
  const char *directory = std::getenv("EULASTIC_COUNT");
  if (!directory) return;
  const std::string path = std::string(directory) + "/" + std::to_string(rank_of(MPI_COMM_WORLD)) + ".csv";
  std::FILE *file = std::fopen(path.c_str(), "w");
  if (!file) return;
  std::fprintf(file, "stage,verb,kind,partner,calls,bytes,largest,seconds\n");
  for (const auto &[key, sum] : sums) {
    const auto &[stage, verb, kind, partner] = key;
    std::fprintf(file, "%s,%s,%s,%d,%ld,%ld,%ld,%.9g\n", stage.c_str(), verb.c_str(), kind.c_str(), partner, sum.calls,
                 sum.bytes, sum.largest, sum.seconds);
  }
  std::fclose(file);
}

}  // namespace

extern "C" {

int MPI_Finalize() {
  write();
  return PMPI_Finalize();
}

// Point to point: blocking, not blocking, persistent.
#define SEND(NOW, LATER, PERSISTENT)                                                                                  \
  int MPI_##NOW(const void *data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm) {                         \
    sends(to, n, type, comm);                                                                                         \
    return PMPI_##NOW(data, n, type, to, tag, comm);                                                                  \
  }                                                                                                                   \
  int MPI_##LATER(const void *data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request *request) { \
    sends(to, n, type, comm);                                                                                         \
    return PMPI_##LATER(data, n, type, to, tag, comm, request);                                                       \
  }                                                                                                                   \
  int MPI_##PERSISTENT(const void *data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm,                    \
                       MPI_Request *request) {                                                                        \
    const int status = PMPI_##PERSISTENT(data, n, type, to, tag, comm, request);                                      \
    is_persistent(to, n, type, comm, *request);                                                                       \
    return status;                                                                                                    \
  }
SEND(Send, Isend, Send_init)
SEND(Ssend, Issend, Ssend_init)
SEND(Bsend, Ibsend, Bsend_init)
SEND(Rsend, Irsend, Rsend_init)

int MPI_Start(MPI_Request *request) {
  starts(*request);
  return PMPI_Start(request);
}

int MPI_Startall(int n, MPI_Request requests[]) {
  for (int r = 0; r < n; ++r) starts(requests[r]);
  return PMPI_Startall(n, requests);
}

int MPI_Request_free(MPI_Request *request) {
  persistent.erase(*request);
  persistent_receives.erase(*request);
  return PMPI_Request_free(request);
}

int MPI_Irecv(void *in, int n, MPI_Datatype type, int from, int tag, MPI_Comm comm, MPI_Request *request) {
  receives(from, comm);
  return PMPI_Irecv(in, n, type, from, tag, comm, request);
}

int MPI_Recv(void *in, int n, MPI_Datatype type, int from, int tag, MPI_Comm comm, MPI_Status *status) {
  waits_to_receive(from, comm);
  return PMPI_Recv(in, n, type, from, tag, comm, status);
}

int MPI_Recv_init(void *in, int n, MPI_Datatype type, int from, int tag, MPI_Comm comm, MPI_Request *request) {
  const int status = PMPI_Recv_init(in, n, type, from, tag, comm, request);
  if (travels(from, comm)) persistent_receives.insert(*request);
  return status;
}

int MPI_Wait(MPI_Request *request, MPI_Status *status) {
  if (*request != MPI_REQUEST_NULL) has_waited();
  return PMPI_Wait(request, status);
}

int MPI_Waitall(int n, MPI_Request requests[], MPI_Status statuses[]) {
  if (n > 0) has_waited();
  return PMPI_Waitall(n, requests, statuses);
}

int MPI_Waitany(int n, MPI_Request requests[], int *which, MPI_Status *status) {
  if (n > 0) has_waited();
  return PMPI_Waitany(n, requests, which, status);
}

int MPI_Waitsome(int n, MPI_Request requests[], int *done, int which[], MPI_Status statuses[]) {
  if (n > 0) has_waited();
  return PMPI_Waitsome(n, requests, done, which, statuses);
}

int MPI_Sendrecv(const void *data, int n, MPI_Datatype type, int to, int tag, void *in, int in_n, MPI_Datatype in_type,
                 int from, int in_tag, MPI_Comm comm, MPI_Status *status) {
  sends(to, n, type, comm);
  receives(from, comm);
  has_waited();
  return PMPI_Sendrecv(data, n, type, to, tag, in, in_n, in_type, from, in_tag, comm, status);
}

int MPI_Sendrecv_replace(void *data, int n, MPI_Datatype type, int to, int tag, int from, int in_tag, MPI_Comm comm,
                         MPI_Status *status) {
  sends(to, n, type, comm);
  receives(from, comm);
  has_waited();
  return PMPI_Sendrecv_replace(data, n, type, to, tag, from, in_tag, comm, status);
}

// Collectives, each with its form that does not block: parameters, bytes, arguments.
#define COLLECTIVE(NOW, LATER, BYTES, PARAMETERS, ...)               \
  int MPI_##NOW(PARAMETERS, MPI_Comm comm) {                         \
    const Collective scope(#NOW, BYTES, comm);                       \
    return PMPI_##NOW(__VA_ARGS__, comm);                            \
  }                                                                  \
  int MPI_##LATER(PARAMETERS, MPI_Comm comm, MPI_Request *request) { \
    const Collective scope(#NOW, BYTES, comm);                       \
    return PMPI_##LATER(__VA_ARGS__, comm, request);                 \
  }
#define LIST(...) __VA_ARGS__
#define OUT const void *data, int n, MPI_Datatype type
#define OUT_V const void *data, const int *counts, const int *places, MPI_Datatype type
#define IN void *in, int in_n, MPI_Datatype in_type
#define IN_V void *in, const int *in_counts, const int *in_places, MPI_Datatype in_type
#define SIZE size_of(n, type)
#define IN_SIZE size_of(in_n, in_type)
COLLECTIVE(Allreduce, Iallreduce, SIZE, LIST(const void *data, void *in, int n, MPI_Datatype type, MPI_Op op), data, in,
           n, type, op)
COLLECTIVE(Scan, Iscan, SIZE, LIST(const void *data, void *in, int n, MPI_Datatype type, MPI_Op op), data, in, n, type,
           op)
COLLECTIVE(Exscan, Iexscan, SIZE, LIST(const void *data, void *in, int n, MPI_Datatype type, MPI_Op op), data, in, n,
           type, op)
COLLECTIVE(Reduce, Ireduce, SIZE, LIST(const void *data, void *in, int n, MPI_Datatype type, MPI_Op op, int root), data,
           in, n, type, op, root)
COLLECTIVE(Reduce_scatter_block, Ireduce_scatter_block, SIZE *ranks_of(comm),
           LIST(const void *data, void *in, int n, MPI_Datatype type, MPI_Op op), data, in, n, type, op)
COLLECTIVE(Reduce_scatter, Ireduce_scatter, size_of(total(counts, comm), type),
           LIST(const void *data, void *in, const int *counts, MPI_Datatype type, MPI_Op op), data, in, counts, type,
           op)
COLLECTIVE(Bcast, Ibcast, SIZE, LIST(void *data, int n, MPI_Datatype type, int root), data, n, type, root)
COLLECTIVE(Allgather, Iallgather, IN_SIZE *ranks_of(comm), LIST(OUT, IN), data, n, type, in, in_n, in_type)
COLLECTIVE(Allgatherv, Iallgatherv, size_of(total(in_counts, comm), in_type), LIST(OUT, IN_V), data, n, type, in,
           in_counts, in_places, in_type)
COLLECTIVE(Gather, Igather, rank_of(comm) == root ? IN_SIZE * ranks_of(comm) : SIZE, LIST(OUT, IN, int root), data, n,
           type, in, in_n, in_type, root)
COLLECTIVE(Gatherv, Igatherv, rank_of(comm) == root ? size_of(total(in_counts, comm), in_type) : SIZE,
           LIST(OUT, IN_V, int root), data, n, type, in, in_counts, in_places, in_type, root)
COLLECTIVE(Scatter, Iscatter, rank_of(comm) == root ? SIZE * ranks_of(comm) : IN_SIZE, LIST(OUT, IN, int root), data, n,
           type, in, in_n, in_type, root)
COLLECTIVE(Scatterv, Iscatterv, rank_of(comm) == root ? size_of(total(counts, comm), type) : IN_SIZE,
           LIST(OUT_V, IN, int root), data, counts, places, type, in, in_n, in_type, root)
COLLECTIVE(Alltoall, Ialltoall, IN_SIZE *ranks_of(comm), LIST(OUT, IN), data, n, type, in, in_n, in_type)
COLLECTIVE(Alltoallv, Ialltoallv,
           std::max(size_of(total(counts, comm), type), size_of(total(in_counts, comm), in_type)), LIST(OUT_V, IN_V),
           data, counts, places, type, in, in_counts, in_places, in_type)

int MPI_Barrier(MPI_Comm comm) {
  const Collective scope("Barrier", 0, comm);
  return PMPI_Barrier(comm);
}

int MPI_Ibarrier(MPI_Comm comm, MPI_Request *request) {
  const Collective scope("Barrier", 0, comm);
  return PMPI_Ibarrier(comm, request);
}

int MPI_Neighbor_alltoallv(OUT_V, IN_V, MPI_Comm comm) {
  to_neighbours(counts, type, comm);
  has_waited();
  return PMPI_Neighbor_alltoallv(data, counts, places, type, in, in_counts, in_places, in_type, comm);
}

int MPI_Ineighbor_alltoallv(OUT_V, IN_V, MPI_Comm comm, MPI_Request *request) {
  to_neighbours(counts, type, comm);
  return PMPI_Ineighbor_alltoallv(data, counts, places, type, in, in_counts, in_places, in_type, comm, request);
}

int MPI_Comm_dup(MPI_Comm comm, MPI_Comm *made) {
  const Collective scope("Comm_dup", 0, comm);
  return PMPI_Comm_dup(comm, made);
}

int MPI_Comm_split(MPI_Comm comm, int colour, int key, MPI_Comm *made) {
  const Collective scope("Comm_split", 0, comm);
  return PMPI_Comm_split(comm, colour, key, made);
}

}  // extern "C"
