// The threads of a rank. The main thread alone calls MPI and PETSc; the others, the workers, wait for work between
// parallel regions.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace eulastic {

/// The way in which a worker waits for the next parallel region.
enum class Waiting {
  spin,   ///< polls for some milliseconds before it sleeps, and responds within a microsecond
  sleep,  ///< sleeps almost at once, so that its core is free for other threads
};

/// The threads of a rank, which run parallel regions together.
class ThreadTeam {
public:
  ThreadTeam() noexcept { set_waiting(Waiting::sleep); }
  ~ThreadTeam() { resize(1); }
  ThreadTeam(const ThreadTeam &) = delete;
  ThreadTeam &operator=(const ThreadTeam &) = delete;
  /// Returns the team of this rank. Initially it consists of one thread, with Waiting::sleep.
  /// That of this rank: one thread, which sleeps when it waits, until told otherwise.
  static ThreadTeam &team_of_rank() noexcept;
  /// Sets the number of threads, 1 to 65,535.
  /// `size`: threads, at least 1 and at most 65,535.
  void resize(int size);
  int size() const noexcept { return static_cast<int>(workers_.size()) + 1; }
  /// Whether the calling thread is inside of run().
  static bool is_in_parallel_region() noexcept;
  /// Must be called outside of run().
  void set_waiting(Waiting how) noexcept;

  /// Calls work(t) for 0 <= t < members <= size() on thread t and returns when all have finished. Only the main thread
  /// may call it, outside of a parallel region. Rethrows an exception of any thread.
  template <class Work>
  void run(int members, const Work &work) {
    run(
        members, [](const void *given, int thread) { (*static_cast<const Work *>(given))(thread); }, &work);
  }

private:
  using Call = void (*)(const void *work, int thread);
  void run(int members, Call call, const void *work);
  void serve(int thread);
  std::uint64_t wait_for_region(std::uint64_t last);
  void call_work(int thread) noexcept;

  static constexpr int members_bits = 16;
  /// Counter of parallel regions, and in the lowest bits the number of threads that take part. A thread that takes no
  /// part must not read anything else of the region, which may have ended.
  std::atomic<std::uint64_t> region_{0};
  std::atomic<int> running_{0}, asleep_{0};
  std::atomic<int> spins_;  ///< number of polls before a waiting thread sleeps
  std::atomic<bool> stop_{false};
  Call call_ = nullptr;
  const void *work_ = nullptr;
  std::exception_ptr thrown_;
  std::mutex mutex_;  ///< protects thrown_ and the sleep of workers
  std::condition_variable wake_;
  std::vector<std::thread> workers_;
};

/// Marks a thread, from construction to destruction, as one that processes whole tasks, such as bodies in boxes: it
/// runs all loops of its task alone, logs no events and calls no MPI.
class TeamMember {
public:
  /// `number` is that of the thread in its team, from 0. The flops of its routines are added to *flops.
  TeamMember(int number, double *flops) noexcept;
  ~TeamMember();
  TeamMember(const TeamMember &) = delete;
  TeamMember &operator=(const TeamMember &) = delete;

  /// Whether the calling thread is a team member.
  static bool is_here() noexcept;
  /// Returns the number of the calling thread in its team; 0 outside of a team.
  static int number() noexcept;
  static void add_flops(double count) noexcept;
};

}  // namespace eulastic
