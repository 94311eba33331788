// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/parallel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "../expect_error.hpp"

namespace petzval {
namespace parallel_test {

TEST(ParallelFor, RunsEveryIndexOnce) {
  for (const std::size_t count : {1u, 2u, 63u, 64u, 65u, 1000u, 4099u}) {
    for (const std::size_t block : {1u, 7u, 64u, 4099u, 5000u}) {
      for (const int threads : {1, 2, 3, 8}) {
        std::vector<std::atomic<int>> times(count);
        parallel_for(count, block, threads, [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) ++times[i];
        });
        ASSERT_TRUE(std::all_of(times.begin(), times.end(), [](const auto& n) { return n == 1; }))
            << count << " things in blocks of " << block << " on " << threads << " threads";
      }
    }
  }
}

TEST(ParallelFor, BlocksAreIndependentOfThreads) {
  for (const int threads : {1, 4}) {
    std::vector<std::size_t> ends(100, 0);
    parallel_for(100, 30, threads, [&](std::size_t begin, std::size_t end) { ends[begin] = end; });
    std::vector<std::size_t> wanted(100, 0);
    wanted[0] = 30, wanted[30] = 60, wanted[60] = 90, wanted[90] = 100;
    EXPECT_EQ(ends, wanted) << threads;
  }
}

TEST(ParallelFor, SumsOfBlocksAreIndependentOfThreads) {
  // The rounding of sums depends on their order. Sums over blocks in fixed order are bitwise equal.
  const auto sum = [](int threads) {
    std::vector<double> parts(101, 0);
    parallel_for(10007, 100, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) parts[begin / 100] += std::sin(static_cast<double>(i));
    });
    return std::accumulate(parts.begin(), parts.end(), 0.0);
  };
  for (const int threads : {2, 5, 16}) EXPECT_EQ(sum(threads), sum(1)) << threads;
}

TEST(ParallelFor, EmptyRangeDoesNothing) {
  int calls = 0;
  for (const int threads : {1, 4}) parallel_for(0, 64, threads, [&](std::size_t, std::size_t) { ++calls; });
  EXPECT_EQ(calls, 0);
}

TEST(ParallelFor, AcceptsHugeBlocks) {
  constexpr std::size_t largest = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> seen;
  parallel_for(10, largest, 2, [&](std::size_t begin, std::size_t end) { seen.insert(seen.end(), {begin, end}); });
  EXPECT_EQ(seen, (std::vector<std::size_t>{0, 10}));
}

TEST(ParallelFor, RefusesAnEmptyFunction) { EXPECT_THROW(parallel_for(1, 1, 1, {}), petzval::Error); }

TEST(ParallelFor, StartsNoThreadForOneOrASingleBlock) {
  const auto caller = std::this_thread::get_id();
  const auto all_by_the_caller = [&](std::size_t count, int threads) {
    std::atomic<bool> all = true;
    parallel_for(count, 10, threads, [&](std::size_t, std::size_t) {
      if (std::this_thread::get_id() != caller) all = false;
    });
    return all.load();
  };
  EXPECT_TRUE(all_by_the_caller(1000, 1));
  EXPECT_TRUE(all_by_the_caller(10, 8));
}

TEST(ParallelFor, UsesTheRequestedThreadsUpToTheNumberOfBlocks) {
  // Every block waits until all blocks have begun: too few threads would hang the test.
  const auto caller = std::this_thread::get_id();
  for (const int threads : {3, 50}) {
    const std::size_t together = std::min(threads, 6);
    std::atomic<std::size_t> begun = 0;
    std::vector<std::thread::id> by(6);
    parallel_for(60, 10, threads, [&](std::size_t begin, std::size_t) {
      by[begin / 10] = std::this_thread::get_id();
      ++begun;
      while (begun < together) std::this_thread::yield();
    });
    const std::set<std::thread::id> team(by.begin(), by.end());
    EXPECT_GE(team.size(), together);
    EXPECT_LE(team.size(), static_cast<std::size_t>(threads));
    EXPECT_TRUE(team.contains(caller));
  }
}

TEST(ParallelFor, RethrowsTheFirstException) {
  for (const int threads : {1, 2, 7}) {
    std::atomic<int> begun = 0;
    try {
      parallel_for(100000, 1, threads, [&](std::size_t begin, std::size_t) {
        ++begun;
        if (begin >= 40) throw std::runtime_error(std::to_string(begin));
      });
      ADD_FAILURE() << "no exception on " << threads;
    } catch (const std::runtime_error& e) {
      EXPECT_STREQ(e.what(), "40") << threads;
    }
    // Blocks that have not begun are skipped: at most one more block runs on each other thread.
    EXPECT_GE(begun, 41);
    EXPECT_LE(begun, 40 + threads);
  }
}

TEST(ProcessorThreads, AreAtLeastOne) { EXPECT_GE(processor_threads(), 1); }

TEST(ParallelFor, RefusesInvalidArguments) {
  const auto nothing = [](std::size_t, std::size_t) {};
  testing::expect_error([&] { parallel_for(0, 0, 1, nothing); }, {"parallel_for", "block", 0});
  testing::expect_error([&] { parallel_for(0, 1, 0, nothing); }, {"parallel_for", "threads", 0});
  testing::expect_error([&] { parallel_for(0, 1, -3, nothing); }, {"parallel_for", "threads", -3});
}

}  // namespace parallel_test
}  // namespace petzval
