// SPDX-License-Identifier: Apache-2.0
// A queue of waiting requests.
#include "serve/http/work_slots.hpp"

#include <algorithm>

#include "serve/http/refusal.hpp"

namespace cluxel::serve {

WorkSlots::Slot WorkSlots::take(const std::function<bool()>& is_abandoned) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds between_looks{100};
  std::unique_lock lock(mutex_);
  if (free_ > 0) {
    --free_;
    return Slot(*this);
  }
  if (waiters_.size() >= max_waiting_) throw busy("the server is busy and its queue is full; ask again later");
  const auto waiter = waiters_.emplace(waiters_.end());
  const auto end = Clock::now() + patience_;
  bool is_left = false;
  while (!waiter->is_granted && !is_left && Clock::now() < end) {
    waiter->granted.wait_until(lock, std::min(end, Clock::now() + between_looks), [&] { return waiter->is_granted; });
    is_left = is_abandoned && is_abandoned();
  }
  const bool is_granted = waiter->is_granted;
  waiters_.erase(waiter);
  if (is_left) {
    if (is_granted) passOn();
    throw abandoned();
  }
  if (!is_granted) throw busy("the server was busy for too long; ask again later");
  return Slot(*this);
}

void WorkSlots::release() {
  const std::lock_guard lock(mutex_);
  passOn();
}

/// The slot goes to the first that waits; one that was granted stays in the list until its thread runs.
void WorkSlots::passOn() {
  for (Waiter& waiter : waiters_) {
    if (waiter.is_granted) continue;
    waiter.is_granted = true;
    waiter.granted.notify_one();
    return;
  }
  ++free_;
}

}  // namespace cluxel::serve
