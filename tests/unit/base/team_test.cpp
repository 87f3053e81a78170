// The threads of a rank: every thread takes part in every region, with either way of waiting.
#include "base/team.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <string>

namespace eulastic {
namespace {

class ThreadTeamTest : public testing::TestWithParam<Waiting> {
protected:
  ThreadTeamTest() { team.set_waiting(GetParam()); }
  ThreadTeam team;
};

INSTANTIATE_TEST_SUITE_P(Both, ThreadTeamTest, testing::Values(Waiting::spin, Waiting::sleep));

// The parts of a region are written by its threads alone and read afterwards by the main thread.
TEST_P(ThreadTeamTest, EveryMemberDoesItsPartOnce) {
  for (const int size : {1, 2, 5}) {
    team.resize(size);
    EXPECT_EQ(team.size(), size);
    std::vector<int> done(size, 0);
    std::vector<std::thread::id> by(size);
    std::vector<int> wanted(size, 0);
    for (int region = 0; region < 500; ++region) {
      const int members = 1 + region % size;  // other threads may still be finishing when the next region begins
      team.run(members, [&](int thread) {
        ++done[thread];
        if (region < size) by[thread] = std::this_thread::get_id();
        EXPECT_EQ(by[thread], std::this_thread::get_id());
        EXPECT_TRUE(ThreadTeam::is_in_parallel_region());
      });
      for (int t = 0; t < members; ++t) ++wanted[t];
    }
    EXPECT_EQ(done, wanted);
    EXPECT_EQ(by[0], std::this_thread::get_id());
    EXPECT_FALSE(ThreadTeam::is_in_parallel_region());
  }
}

// A thread that has been asleep for a long time wakes up for its part.
TEST_P(ThreadTeamTest, SleepersWake) {
  team.resize(3);
  std::atomic<int> done{0};
  for (int region = 0; region < 3; ++region) {
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    team.run(3, [&](int) { ++done; });
  }
  EXPECT_EQ(done, 9);
}

TEST_P(ThreadTeamTest, ThrowsWhatAMemberHasThrown) {
  team.resize(3);
  for (const int thrower : {0, 2}) {
    std::atomic<int> done{0};
    const auto work = [&](int thread) {
      ++done;
      if (thread == thrower) throw std::runtime_error("thread " + std::to_string(thread));
    };
    try {
      team.run(3, work);
      ADD_FAILURE() << "nothing was thrown";
    } catch (const std::runtime_error &error) {
      EXPECT_EQ(error.what(), "thread " + std::to_string(thrower));
    }
    EXPECT_EQ(done, 3);
    team.run(3, [&](int) { ++done; });
    EXPECT_EQ(done, 6);
  }
}

}  // namespace
}  // namespace eulastic
