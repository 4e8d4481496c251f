// SPDX-License-Identifier: Apache-2.0
// One thread for each open connection, up to a limit; threads are used again.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <list>
#include <mutex>
#include <thread>
#include <vector>

namespace cluxel::serve {

class HttpThreads {
 public:
  explicit HttpThreads(std::size_t max_threads) : max_threads_(max_threads) {}

  /// Beyond the limit, and where the system has no more threads, `serve` runs at once in the calling thread, where
  /// isRefused() is then true.
  void enqueue(std::function<void()> serve);
  /// Waits for all connections.
  void shutdown();

  /// True in a connection that must be refused.
  static bool isRefused();

 private:
  bool hasFreeThread();
  void work();

  std::size_t max_threads_, busy_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_ending_ = false;
  std::list<std::function<void()>> waiting_;
  std::vector<std::thread> threads_;
};

}  // namespace cluxel::serve
