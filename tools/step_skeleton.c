/* A step without its arithmetic: the messages and collectives of tools/step_counts.csv on a periodic box of ranks, for
   scripts/studies/scaling/simulate_scaling. With MPI it sends what the program sends; with SimGrid's SMPI it also says how long that
   takes. Usage: step_skeleton X Y Z SECONDS FILE; SECONDS of arithmetic; FILE has lines
     send DX DY DZ CALLS BYTES      to the rank at that place from here, bytes of all calls together
     Allreduce CALLS BYTES          bytes of all calls together
     Allgatherv CALLS BYTES
   Messages go in rounds, one to each neighbour, and each round is waited for. */
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { most = 128 };
struct Send {
  int place[3];
  long calls, bytes;
};
struct Collective {
  int reduces;
  long calls, bytes;
};

static struct Send sends[most];
static struct Collective collectives[most];
static int send_count, collective_count;

static int read_file(const char *path) {
  FILE *file = fopen(path, "r");
  char kind[32];
  if (!file) return 1;
  while (fscanf(file, "%31s", kind) == 1) {
    if (send_count == most || collective_count == most) return 1;
    if (!strcmp(kind, "send")) {
      struct Send *s = &sends[send_count++];
      if (fscanf(file, "%d %d %d %ld %ld", &s->place[0], &s->place[1], &s->place[2], &s->calls, &s->bytes) != 5)
        return 1;
    } else {
      struct Collective *c = &collectives[collective_count++];
      c->reduces = !strcmp(kind, "Allreduce");
      if (fscanf(file, "%ld %ld", &c->calls, &c->bytes) != 2) return 1;
    }
  }
  fclose(file);
  return 0;
}

/* Bytes of one of `calls` that have so many together. */
static int share(long bytes, long calls, long call) { return (int)(bytes * (call + 1) / calls - bytes * call / calls); }

static int rank_at(const int *n, const int *here, const int *place, int sign) {
  int at[3];
  for (int d = 0; d < 3; ++d) at[d] = (here[d] + sign * place[d] + n[d]) % n[d];
  return at[0] + n[0] * (at[1] + n[1] * at[2]);
}

static void exchange(const int *n, const int *here, char *out, char *in) {
  long rounds = 0;
  for (int s = 0; s < send_count; ++s) rounds = sends[s].calls > rounds ? sends[s].calls : rounds;
  for (long round = 0; round < rounds; ++round) {
    MPI_Request requests[2 * most];
    int count = 0;
    for (int s = 0; s < send_count; ++s) {
      if (round >= sends[s].calls) continue;
      const int size = share(sends[s].bytes, sends[s].calls, round);
      MPI_Irecv(in, size, MPI_BYTE, rank_at(n, here, sends[s].place, -1), s, MPI_COMM_WORLD, &requests[count++]);
      MPI_Isend(out, size, MPI_BYTE, rank_at(n, here, sends[s].place, 1), s, MPI_COMM_WORLD, &requests[count++]);
    }
    MPI_Waitall(count, requests, MPI_STATUSES_IGNORE);
  }
}

static void collect(int ranks, int rank, char *out, char *in) {
  int *counts = malloc(sizeof(int) * ranks), *places = malloc(sizeof(int) * ranks);
  for (int c = 0; c < collective_count; ++c)
    for (long call = 0; call < collectives[c].calls; ++call) {
      const int size = share(collectives[c].bytes, collectives[c].calls, call);
      if (collectives[c].reduces) {
        MPI_Allreduce(out, in, size, MPI_BYTE, MPI_BOR, MPI_COMM_WORLD);
        continue;
      }
      for (int r = 0; r < ranks; ++r) {
        places[r] = (int)((long)size * r / ranks);
        counts[r] = (int)((long)size * (r + 1) / ranks) - places[r];
      }
      MPI_Allgatherv(out, counts[rank], MPI_BYTE, in, counts, places, MPI_BYTE, MPI_COMM_WORLD);
    }
  free(counts);
  free(places);
}

int main(int argc, char **argv) {
  int rank, ranks, n[3], here[3];
  long largest = 1 << 20;
  MPI_Init(&argc, &argv);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  for (int d = 0; d < 3 && argc == 6; ++d) n[d] = atoi(argv[d + 1]);
  if (argc != 6 || n[0] * n[1] * n[2] != ranks || read_file(argv[5])) {
    fprintf(stderr, "usage: step_skeleton X Y Z SECONDS FILE, on X * Y * Z ranks\n");
    MPI_Abort(MPI_COMM_WORLD, 2);
  }
  here[0] = rank % n[0], here[1] = rank / n[0] % n[1], here[2] = rank / n[0] / n[1];
  for (int s = 0; s < send_count; ++s) largest = sends[s].bytes > largest ? sends[s].bytes : largest;
  char *out = calloc(largest, 1), *in = calloc(largest, 1);
  const double begin = MPI_Wtime();
#ifdef SMPI_H
  smpi_execute_flops(1e9 * atof(argv[4])); /* hosts of 1 Gflop/s */
#endif
  exchange(n, here, out, in);
  collect(ranks, rank, out, in);
  const double own = MPI_Wtime() - begin;
  double slowest = 0;
  PMPI_Reduce(&own, &slowest, 1, MPI_DOUBLE, MPI_MAX, 0, MPI_COMM_WORLD); /* not counted */
  if (rank == 0) printf("%.9g\n", slowest);
  free(out);
  free(in);
  MPI_Finalize();
  return 0;
}
