// SPDX-License-Identifier: Apache-2.0
// Rates, and the queue of requests.
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <thread>
#include <vector>

#include "serve/http/rate_limit.hpp"
#include "serve/http/refusal.hpp"
#include "serve/http/work_slots.hpp"

namespace cluxel::serve {
namespace {

using std::chrono::milliseconds;

TEST(RateLimit, AdmitsABurstAndThenTheRate) {
  RateLimit limit(10);
  RateLimit::Clock::time_point now{};
  int burst = 0;
  while (limit.admit("a", now)) ++burst;
  EXPECT_EQ(burst, 20);
  EXPECT_TRUE(limit.admit("b", now)) << "each client has its own";
  EXPECT_FALSE(limit.admit("a", now + milliseconds(99)));
  EXPECT_TRUE(limit.admit("a", now + milliseconds(201)));
}

TEST(RateLimit, NoClientGetsMoreThanTheRateOverTime) {
  RateLimit limit(4);
  RateLimit::Clock::time_point now{};
  int admitted = 0;
  for (int i = 0; i < 10'000; ++i) admitted += limit.admit("a", now + milliseconds(i)) ? 1 : 0;
  EXPECT_LE(admitted, 8 + 40);
  EXPECT_GE(admitted, 8 + 38);
}

TEST(RateLimit, ForgetsClientsThatHaveNotAskedForLong) {
  RateLimit limit(1);
  RateLimit::Clock::time_point now{};
  for (int i = 0; i < 20'000; ++i) limit.admit("client " + std::to_string(i), now + milliseconds(i));
  EXPECT_LE(limit.clientCount(), 4096U);
}

TEST(WorkSlots, RunAtMostTheirNumberAtOnceAndAllInTheEnd) {
  WorkSlots slots(3, 100, milliseconds(10'000));
  std::atomic<int> running = 0, most = 0, done = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 40; ++i)
    threads.emplace_back([&] {
      const WorkSlots::Slot slot = slots.take();
      const int now = ++running;
      for (int seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
      }
      std::this_thread::sleep_for(milliseconds(2));
      --running;
      ++done;
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(done, 40);
  EXPECT_EQ(most, 3);
}

int statusOfTaking(WorkSlots& slots) {
  try {
    slots.take();
    return 200;
  } catch (const Refusal& refusal) {
    EXPECT_EQ(refusal.headers().at(0).first, "Retry-After");
    return refusal.status();
  }
}

TEST(WorkSlots, AFullQueueAndALongWaitAreRefused) {
  WorkSlots none(1, 0, milliseconds(10'000)), impatient(1, 1, milliseconds(20));
  const WorkSlots::Slot held = none.take();
  EXPECT_EQ(statusOfTaking(none), 503);
  {
    const WorkSlots::Slot also_held = impatient.take();
    EXPECT_EQ(statusOfTaking(impatient), 503);
  }
  EXPECT_EQ(statusOfTaking(impatient), 200) << "a wait that ended takes nothing with it";
}

TEST(WorkSlots, WhoGivesUpWaitingLeavesTheQueue) {
  WorkSlots slots(1, 1, milliseconds(60'000));
  const WorkSlots::Slot held = slots.take();
  for (int i = 0; i < 2; ++i) {
    try {
      slots.take([] { return true; });
      FAIL() << "the slot is taken";
    } catch (const Refusal& refusal) {
      EXPECT_EQ(refusal.status(), 499);
    }
  }
}

TEST(WorkSlots, RequestsRunInTheOrderInWhichTheyCame) {
  WorkSlots slots(1, 10, milliseconds(10'000));
  std::vector<int> order;
  std::vector<std::thread> threads;
  {
    const WorkSlots::Slot held = slots.take();
    for (int i = 0; i < 5; ++i) {
      threads.emplace_back([&slots, &order, i] {
        const WorkSlots::Slot slot = slots.take();
        order.push_back(i);
      });
      std::this_thread::sleep_for(milliseconds(30));
    }
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 3, 4}));
}

}  // namespace
}  // namespace cluxel::serve
