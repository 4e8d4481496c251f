// SPDX-License-Identifier: Apache-2.0
// Bounds how many requests run at once and how many wait for their turn.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>

namespace cluxel::serve {

/// Requests run in the order in which they came. Thread-safe.
class WorkSlots {
 public:
  /// At least one runs; at most `waiting` wait, each for at most `patience`.
  WorkSlots(std::size_t running, std::size_t waiting, std::chrono::milliseconds patience)
      : free_(running > 0 ? running : 1), max_waiting_(waiting), patience_(patience) {}

  /// Gives its place back when it is destroyed.
  class Slot {
   public:
    explicit Slot(WorkSlots& owner) : owner_(&owner) {}
    Slot(Slot&& other) noexcept : owner_(other.owner_) { other.owner_ = nullptr; }
    Slot& operator=(Slot&&) = delete;
    ~Slot() {
      if (owner_ != nullptr) owner_->release();
    }

   private:
    WorkSlots* owner_;
  };

  /// Waits for a slot. Throws Refusal (503) when the queue is full or the wait is too long, and (499) when
  /// `is_abandoned` says meanwhile that nobody waits for the work any more.
  Slot take(const std::function<bool()>& is_abandoned = {});

 private:
  struct Waiter {
    std::condition_variable granted;
    bool is_granted = false;
  };
  void release();
  void passOn();  ///< under the lock

  std::mutex mutex_;
  std::size_t free_;
  std::size_t max_waiting_;
  std::chrono::milliseconds patience_;
  std::list<Waiter> waiters_;
};

}  // namespace cluxel::serve
