// SPDX-License-Identifier: Apache-2.0
// Resource accounting of a query: time, rows, memory.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <vector>

#include "sparql/query_engine.hpp"

namespace cluxel::sparql {

/// Throws Error (BudgetExceeded) as soon as a budget is exceeded.
class Guard {
 public:
  /// The used part of a budget.
  struct Usage {
    std::chrono::steady_clock::duration time{};
    std::uint64_t work_rows = 0;
    std::size_t bytes = 0;
  };
  void start(const QueryBudget& budget) { start(budget, {}); }
  /// Adds `used` to this query's usage.
  void start(const QueryBudget& budget, const Usage& used);
  Usage usage() const { return {std::chrono::steady_clock::now() - start_, work_rows_, bytes_}; }
  /// Counts `rows` produced or examined rows.
  void work(std::uint64_t rows) {
    work_rows_ += rows;
    if (work_rows_ >= next_check_) check();
  }
  void charge(std::size_t bytes) {
    bytes_ += bytes;
    if (bytes_ > max_bytes_) refuse("memory");
  }
  /// Charges a shared resource once per run.
  void chargeOnce(const void* thing, std::size_t bytes) {
    if (std::find(shared_.begin(), shared_.end(), thing) != shared_.end()) return;
    shared_.push_back(thing);
    charge(bytes);
  }
  /// For memory that is about to be held for a moment, such as the copy of a growing array.
  void requireRoomFor(std::size_t bytes) const {
    if (!hasRoomFor(bytes)) refuse("memory");
  }
  /// Counts bytes that were computed or read between batches, and checks the deadline once in a while.
  void spend(std::size_t bytes) {
    spent_ += bytes;
    if (spent_ < kBytesBetweenChecks) return;
    spent_ = 0;
    checkTime();
  }
  /// Charges what the syntax tree, the algebra and the plan hold for these tokens, and checks the deadline.
  void chargeForTokens(std::size_t tokens) {
    constexpr std::size_t kBytesOfToken = 600;
    charge(tokens * kBytesOfToken);
    checkTime();
  }
  void release(std::size_t bytes) { bytes_ -= std::min(bytes, bytes_); }
  /// True when `bytes` more fit the memory budget.
  bool hasRoomFor(std::size_t bytes) const { return bytes_ <= max_bytes_ && bytes <= max_bytes_ - bytes_; }
  /// For work shared with other queries: checks the deadline and polls only.
  void checkTime() const {
    if (budget_.poll) budget_.poll();
    if (budget_.deadline && std::chrono::steady_clock::now() > deadline_) refuse("time");
  }
  /// Reduces the charged memory to `bytes`.
  void holdOnly(std::size_t bytes) { bytes_ = bytes; }
  void answerRows(std::uint64_t rows) {
    if (rows > max_answer_rows_) refuse("rows of the answer");
  }

 private:
  static constexpr std::size_t kBytesBetweenChecks = std::size_t{1} << 20U;
  void check();
  [[noreturn]] void refuse(const char* what) const;

  QueryBudget budget_;
  std::chrono::steady_clock::time_point start_, deadline_;
  std::uint64_t work_rows_ = 0, next_check_ = 0, max_work_rows_ = 0, max_answer_rows_ = 0;
  std::size_t bytes_ = 0, max_bytes_ = ~std::size_t{0}, spent_ = 0;
  std::vector<const void*> shared_;  ///< resources charged by chargeOnce()
};

}  // namespace cluxel::sparql
