// SPDX-License-Identifier: Apache-2.0
// Every piece once, on any number of threads.
#include "base/parallel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace cluxel {
namespace {

TEST(ParallelFor, CallsEveryPieceOnceForAnyNumberOfThreads) {
  for (const unsigned threads : {0U, 1U, 2U, 7U, 64U})
    for (const std::size_t count : {0U, 1U, 3U, 1000U}) {
      std::vector<std::atomic<int>> calls(count);
      parallelFor(count, threads, [&](std::size_t i) { ++calls[i]; });
      for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(calls[i], 1) << threads << ' ' << i;
    }
}

TEST(ParallelFor, ThrowsTheErrorOfTheSmallestFailingPiece) {
  for (const unsigned threads : {1U, 2U, 5U})
    for (int repeat = 0; repeat < 20; ++repeat) {
      std::string caught;
      try {
        parallelFor(50, threads, [](std::size_t i) {
          if (i % 10 == 3) throw std::runtime_error(std::to_string(i));
        });
      } catch (const std::runtime_error& e) {
        caught = e.what();
      }
      EXPECT_EQ(caught, "3");
    }
}

std::size_t threadsOfProcess() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return static_cast<std::size_t>(std::distance(begin(tasks), end(tasks)));
}

TEST(ParallelFor, MayEndBeforeAllItsThreadsHaveBegunButLeavesFewBehind) {
  std::atomic<std::size_t> calls = 0;
  constexpr std::size_t kFew = 3 * 16;
  for (int repeat = 0; repeat < 2000; ++repeat) {
    const std::vector<std::size_t> numbers(16, 1);  // gone when the last threads begin
    parallelFor(numbers.size(), 16, [&calls, &numbers](std::size_t i) { calls += numbers[i]; });
    // Threads that are ending count, too, and on a busy machine take their time.
    for (int wait = 0; wait < 1000 && threadsOfProcess() > kFew; ++wait)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_LE(threadsOfProcess(), kFew);
  }
  EXPECT_EQ(calls, 2000U * 16U);
}

TEST(ParallelFor, BeginsNoPieceAfterAFailure) {
  for (const unsigned threads : {1U, 4U}) {
    std::atomic<std::size_t> calls = 0;
    EXPECT_THROW(parallelFor(1'000'000, threads,
                             [&](std::size_t) {
                               ++calls;
                               throw std::runtime_error("no");
                             }),
                 std::runtime_error);
    EXPECT_LE(calls, threads);
  }
}

TEST(ParallelInOrder, TakesEveryPieceAfterItsWorkInAscendingOrder) {
  for (const unsigned threads : {0U, 1U, 2U, 7U})
    for (const std::size_t ahead : {1U, 2U, 5U})
      for (const std::size_t count : {0U, 1U, 3U, 500U}) {
        std::vector<std::atomic<int>> worked(count);
        std::vector<std::size_t> taken;
        const std::thread::id caller = std::this_thread::get_id();
        parallelInOrder(
            count, threads, ahead, [&](std::size_t i) { ++worked[i]; },
            [&](std::size_t i) {
              EXPECT_EQ(worked[i], 1) << i;
              EXPECT_EQ(std::this_thread::get_id(), caller);
              taken.push_back(i);
            });
        ASSERT_EQ(taken.size(), count);
        for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(taken[i], i);
      }
}

TEST(ParallelInOrder, BeginsNoPieceBeforeTheOneWhosePlaceItUsesWasTaken) {
  for (const unsigned threads : {1U, 2U, 7U}) {
    constexpr std::size_t kAhead = 3;
    std::vector<std::atomic<std::size_t>> places(kAhead);
    parallelInOrder(
        300, threads, kAhead, [&](std::size_t i) { EXPECT_EQ(places[i % kAhead].exchange(i + 1), 0U); },
        [&](std::size_t i) { EXPECT_EQ(places[i % kAhead].exchange(0), i + 1); });
  }
}

TEST(ParallelInOrder, ThrowsTheErrorOfTheSmallestFailingPiece) {
  for (const unsigned threads : {1U, 2U, 5U})
    for (int repeat = 0; repeat < 20; ++repeat) {
      std::string caught;
      std::size_t taken = 0;
      try {
        parallelInOrder(
            50, threads, 7,
            [](std::size_t i) {
              if (i % 10 == 3) throw std::runtime_error(std::to_string(i));
            },
            [&](std::size_t) { ++taken; });
      } catch (const std::runtime_error& e) {
        caught = e.what();
      }
      EXPECT_EQ(caught, "3");
      EXPECT_LE(taken, 3U);
    }
}

TEST(ParallelInOrder, EndsWhenTakingFails) {
  for (const unsigned threads : {1U, 2U, 5U})
    EXPECT_THROW(parallelInOrder(
                     1000, threads, 4, [](std::size_t) {},
                     [](std::size_t i) {
                       if (i == 20) throw std::runtime_error("no");
                     }),
                 std::runtime_error);
}

}  // namespace
}  // namespace cluxel
