// The threads of a rank. The first is the one that started the program, which alone calls MPI and PETSc; the others
// wait for work from one parallel region to the next.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace eulastic {

/// How a thread waits.
enum class Waiting {
  spin,   ///< it keeps its core, for some milliseconds at least, and goes on within a microsecond
  sleep,  ///< it gives its core to whoever has work
};

class ThreadTeam {
public:
  ThreadTeam() noexcept { set_waiting(Waiting::sleep); }
  ~ThreadTeam() { resize(1); }
  ThreadTeam(const ThreadTeam &) = delete;
  ThreadTeam &operator=(const ThreadTeam &) = delete;

  /// That of this rank: one thread, which sleeps when it waits, until told otherwise.
  static ThreadTeam &of_rank() noexcept;

  /// `size`: threads, at least 1 and at most 65,535.
  void resize(int size);
  int size() const noexcept { return static_cast<int>(others_.size()) + 1; }
  /// Whether the calling thread is inside of run().
  static bool is_in_region() noexcept;
  /// Outside of run().
  void set_waiting(Waiting how) noexcept;

  /// work(t) for 0 <= t < members, at most size(), each on the thread of that number. By the first thread, outside of
  /// work(). Throws what any of them has thrown.
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
  void do_part(int thread) noexcept;

  static constexpr int members_bits = 16;
  /// Number of the parallel region, and of the threads that take part in it. A thread that takes no part reads nothing
  /// else of the region, which may be over before it looks.
  std::atomic<std::uint64_t> region_{0};
  std::atomic<int> running_{0}, asleep_{0};
  std::atomic<int> spins_;  ///< how often a thread looks for work before it sleeps
  std::atomic<bool> ends_{false};
  Call call_ = nullptr;
  const void *work_ = nullptr;
  std::exception_ptr thrown_;
  std::mutex mutex_;  ///< of thrown_ and of those that sleep
  std::condition_variable wake_;
  std::vector<std::thread> others_;
};

/// Marks a thread, from construction to destruction, as one that does whole tasks, each all of a body: it shares its
/// loops with no other, logs no events and calls no MPI.
class TeamMember {
public:
  /// `number`: in the team, from 0 on. `flops`: those of its verbs are added there.
  TeamMember(int number, double *flops) noexcept;
  ~TeamMember();
  TeamMember(const TeamMember &) = delete;
  TeamMember &operator=(const TeamMember &) = delete;

  /// Whether this thread does such tasks.
  static bool is_here() noexcept;
  /// Its number there; 0 outside of any.
  static int number() noexcept;
  static void add_flops(double count) noexcept;
};

}  // namespace eulastic
