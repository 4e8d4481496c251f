// SPDX-License-Identifier: Apache-2.0
// A queue of waiting requests.
#include "serve/http/work_slots.hpp"

#include "serve/http/refusal.hpp"

namespace cluxel::serve {

WorkSlots::Slot WorkSlots::take() {
  std::unique_lock lock(mutex_);
  if (free_ > 0) {
    --free_;
    return Slot(*this);
  }
  if (waiters_.size() >= max_waiting_) throw busy("the server is busy and its queue is full; ask again later");
  const auto waiter = waiters_.emplace(waiters_.end());
  const bool is_granted = waiter->granted.wait_for(lock, patience_, [&] { return waiter->is_granted; });
  waiters_.erase(waiter);
  if (!is_granted) throw busy("the server was busy for too long; ask again later");
  return Slot(*this);
}

/// The slot goes to the first that waits; one that was granted stays in the list until its thread runs.
void WorkSlots::release() {
  const std::lock_guard lock(mutex_);
  for (Waiter& waiter : waiters_) {
    if (waiter.is_granted) continue;
    waiter.is_granted = true;
    waiter.granted.notify_one();
    return;
  }
  ++free_;
}

}  // namespace cluxel::serve
