// SPDX-License-Identifier: Apache-2.0
// Token buckets.
#include "serve/http/rate_limit.hpp"

#include <algorithm>

namespace cluxel::serve {

namespace {

constexpr std::size_t kMaxClients = 4096;

double secondsBetween(RateLimit::Clock::time_point from, RateLimit::Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

}  // namespace

bool RateLimit::admit(const std::string& client, Clock::time_point now) {
  if (per_second_ <= 0) return true;
  const std::lock_guard lock(mutex_);
  if (buckets_.size() >= kMaxClients && !buckets_.contains(client)) forgetFull(now);
  const auto [place, is_new] = buckets_.try_emplace(client, Bucket{capacity(), now});
  Bucket& bucket = place->second;
  bucket.tokens = std::min(capacity(), bucket.tokens + per_second_ * secondsBetween(bucket.filled, now));
  bucket.filled = now;
  if (bucket.tokens < 1) return false;
  bucket.tokens -= 1;
  return true;
}

std::size_t RateLimit::clientCount() const {
  const std::lock_guard lock(mutex_);
  return buckets_.size();
}

/// Drops full buckets: a client without a bucket gets a full one. Drops all when that leaves too many.
void RateLimit::forgetFull(Clock::time_point now) {
  std::erase_if(buckets_, [&](const auto& entry) {
    return entry.second.tokens + per_second_ * secondsBetween(entry.second.filled, now) >= capacity();
  });
  if (buckets_.size() >= kMaxClients) buckets_.clear();
}

}  // namespace cluxel::serve
