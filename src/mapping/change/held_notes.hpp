// SPDX-License-Identifier: Apache-2.0
// Keeps notes about a change until it is committed.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cluxel/progress.hpp"

namespace cluxel::mapping {

/// Notes tell what a change has done: of one that is refused in the end, none is given. Progress goes on at once.
class HeldNotes : public ProgressSink {
 public:
  explicit HeldNotes(ProgressSink& sink) : sink_(sink) {}

  void progress(std::string_view stage, std::size_t done, std::size_t total) override {
    sink_.progress(stage, done, total);
  }
  void note(std::string_view message) override { notes_.emplace_back(message); }
  /// After the commit.
  void give() {
    for (const std::string& note : notes_) sink_.note(note);
    notes_.clear();
  }

 private:
  ProgressSink& sink_;
  std::vector<std::string> notes_;
};

}  // namespace cluxel::mapping
