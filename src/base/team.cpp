#include "base/team.hpp"

#include "base/events.hpp"

#ifdef __x86_64__
#include <immintrin.h>
#endif
#include <sched.h>
#include <utility>

namespace eulastic {
namespace {

// Number of polls before a waiting thread sleeps. With a core of its own a thread polls for about ten milliseconds,
// longer than the time between two parallel regions of a step; on a shared core, for some microseconds.
constexpr int spins_of_own_core = 1000000, spins_of_shared_core = 100;

// Hints to the processor that this thread polls, where the processor has such an instruction.
void relax() noexcept {
#ifdef __x86_64__
  _mm_pause();
#endif
}

thread_local bool is_inside = false;
thread_local int own_number = 0;
thread_local double *own_flops = nullptr;  // null: this thread is no TeamMember

}  // namespace

ThreadTeam &ThreadTeam::team_of_rank() noexcept {
  static ThreadTeam team;
  return team;
}

bool ThreadTeam::is_in_parallel_region() noexcept { return is_inside; }

void ThreadTeam::set_waiting(Waiting how) noexcept {
  spins_ = how == Waiting::spin ? spins_of_own_core : spins_of_shared_core;
}

void ThreadTeam::resize(int size) {
  if (size == this->size()) return;
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    ++region_;
  }
  wake_.notify_all();
  for (std::thread &worker : workers_) worker.join();
  workers_.clear();
  stop_ = false;
  region_ = 0;
  for (int thread = 1; thread < size; ++thread) workers_.emplace_back([this, thread] { serve(thread); });
}

void ThreadTeam::run(int members, Call call, const void *work) {
  const EventScope scope(Event::threads);
  call_ = call;
  work_ = work;
  running_.store(members - 1, std::memory_order_relaxed);
  region_ = (((region_ >> members_bits) + 1) << members_bits) | static_cast<std::uint64_t>(members);
  if (asleep_ > 0) {
    // Taking the lock ensures that no thread is between its test of region_ and its sleep.
    { const std::lock_guard lock(mutex_); }
    wake_.notify_all();
  }
  call_work(0);
  for (int spin = 0; running_.load(std::memory_order_acquire) > 0; ++spin) {
    if (spin < spins_.load(std::memory_order_relaxed))
      relax();
    else
      sched_yield();
  }
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

void ThreadTeam::call_work(int thread) noexcept {
  is_inside = true;
  try {
    call_(work_, thread);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    thrown_ = std::current_exception();
  }
  is_inside = false;
}

// Returns the parallel region that follows `last`, once it has begun.
std::uint64_t ThreadTeam::wait_for_region(std::uint64_t last) {
  for (int spin = spins_.load(std::memory_order_relaxed); spin > 0; --spin) {
    const std::uint64_t region = region_.load(std::memory_order_acquire);
    if (region != last) return region;
    relax();
  }
  std::unique_lock lock(mutex_);
  ++asleep_;
  wake_.wait(lock, [&] { return region_ != last; });
  --asleep_;
  return region_;
}

void ThreadTeam::serve(int thread) {
  for (std::uint64_t region = 0;;) {
    region = wait_for_region(region);
    if (stop_) return;
    if (thread >= static_cast<int>(region & ((1 << members_bits) - 1))) continue;
    call_work(thread);
    running_.fetch_sub(1, std::memory_order_release);
  }
}

TeamMember::TeamMember(int number, double *flops) noexcept {
  own_number = number;
  own_flops = flops;
}

TeamMember::~TeamMember() {
  own_number = 0;
  own_flops = nullptr;
}

bool TeamMember::is_here() noexcept { return own_flops != nullptr; }
int TeamMember::number() noexcept { return own_number; }
void TeamMember::add_flops(double count) noexcept { *own_flops += count; }

}  // namespace eulastic
