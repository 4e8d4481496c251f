// SPDX-License-Identifier: Apache-2.0
// Every piece once, on any number of threads.
#include "base/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
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

}  // namespace
}  // namespace cluxel
