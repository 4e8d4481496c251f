// SPDX-License-Identifier: Apache-2.0
// What a query may use up: time, rows, memory.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <vector>

#include "cluxel/sparql/query_engine.hpp"

namespace cluxel::sparql {

/// Throws Error (BudgetExceeded) as soon as something is used up.
class Guard {
 public:
  /// What of a budget is gone.
  struct Usage {
    std::chrono::steady_clock::duration time{};
    std::uint64_t work_rows = 0;
    std::size_t bytes = 0;
  };
  void start(const QueryBudget& budget) { start(budget, {}); }
  /// `used` counts as if it had been used up here.
  void start(const QueryBudget& budget, const Usage& used);
  Usage usage() const { return {std::chrono::steady_clock::now() - start_, work_rows_, bytes_}; }
  /// `rows` rows were made or looked at.
  void work(std::uint64_t rows) {
    work_rows_ += rows;
    if (work_rows_ >= next_check_) check();
  }
  void charge(std::size_t bytes) {
    bytes_ += bytes;
    if (bytes_ > most_bytes_) refuse("memory");
  }
  /// Counts what the query uses together with others, or in several places, once in a run.
  void chargeOnce(const void* thing, std::size_t bytes) {
    if (std::find(shared_.begin(), shared_.end(), thing) != shared_.end()) return;
    shared_.push_back(thing);
    charge(bytes);
  }
  void release(std::size_t bytes) { bytes_ -= std::min(bytes, bytes_); }
  /// Whether so much may still be charged.
  bool hasRoomFor(std::size_t bytes) const { return bytes_ <= most_bytes_ && bytes <= most_bytes_ - bytes_; }
  /// For work that the query does once for others too: it counts no rows, but ends with the deadline.
  void checkTime() const {
    if (budget_.deadline && std::chrono::steady_clock::now() > deadline_) refuse("time");
  }
  /// What was charged is gone but for `bytes`.
  void holdOnly(std::size_t bytes) { bytes_ = bytes; }
  void answerRows(std::uint64_t rows) {
    if (rows > most_answer_rows_) refuse("rows of the answer");
  }

 private:
  void check();
  [[noreturn]] void refuse(const char* what) const;

  QueryBudget budget_;
  std::chrono::steady_clock::time_point start_, deadline_;
  std::uint64_t work_rows_ = 0, next_check_ = 0, most_work_rows_ = 0, most_answer_rows_ = 0;
  std::size_t bytes_ = 0, most_bytes_ = 0;
  std::vector<const void*> shared_;  ///< what chargeOnce() has counted
};

}  // namespace cluxel::sparql
