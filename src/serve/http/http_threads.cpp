// SPDX-License-Identifier: Apache-2.0
// A pool that grows with the connections.
#include "serve/http/http_threads.hpp"

#include <system_error>
#include <utility>

namespace cluxel::serve {

namespace {
thread_local bool is_refused = false;
}

bool HttpThreads::isRefused() {
  return is_refused;
}

void HttpThreads::enqueue(std::function<void()> serve) {
  {
    const std::lock_guard lock(mutex_);
    if (busy_ + waiting_.size() < max_threads_ && hasFreeThread()) {
      waiting_.push_back(std::move(serve));
      changed_.notify_one();
      return;
    }
  }
  is_refused = true;
  serve();
  is_refused = false;
}

/// Under the lock. Starts a thread when all have something to do.
bool HttpThreads::hasFreeThread() {
  if (busy_ + waiting_.size() < threads_.size()) return true;
  try {
    threads_.emplace_back([this] { work(); });
    return true;
  } catch (const std::system_error&) {  // the system has no more threads
    return false;
  }
}

void HttpThreads::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return is_ending_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const std::function<void()> serve = std::move(waiting_.front());
    waiting_.pop_front();
    ++busy_;
    lock.unlock();
    serve();
    lock.lock();
    --busy_;
  }
}

void HttpThreads::shutdown() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

}  // namespace cluxel::serve
