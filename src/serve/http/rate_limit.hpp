// SPDX-License-Identifier: Apache-2.0
// Limits the number of requests per second of each client.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>
#include <unordered_map>

namespace cluxel::serve {

/// A bucket of tokens for each client: it holds two seconds' worth, at least one. Thread-safe. Clients that have not
/// asked for long are forgotten, so that memory is bounded.
class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;
  /// `per_second` 0: no limit.
  explicit RateLimit(double per_second) : per_second_(per_second) {}

  /// Takes a token; false when there is none.
  bool admit(const std::string& client, Clock::time_point now = Clock::now());
  std::size_t clientCount() const;

 private:
  struct Bucket {
    double tokens = 0;
    Clock::time_point filled;
  };
  double capacity() const { return per_second_ * 2 > 1 ? per_second_ * 2 : 1; }
  void forgetFull(Clock::time_point now);

  double per_second_;
  mutable std::mutex mutex_;
  std::unordered_map<std::string, Bucket> buckets_;
};

}  // namespace cluxel::serve
