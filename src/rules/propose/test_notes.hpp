// SPDX-License-Identifier: Apache-2.0
// What an evaluation compared with thresholds, as far as its outcome hangs on it.
#pragma once

#include <cstddef>
#include <vector>

#include "rules/decide/reasoning_state.hpp"
#include "rules/language/rule_condition.hpp"

namespace cluxel::rules {

/// Collects the tests of one evaluation, and hands them to the margins of the run at its end. Without margins it does
/// nothing.
class TestNotes {
 public:
  explicit TestNotes(const ReasoningState& state) : state_(state), margins_(state.context.margins) {}

  /// `value` of the candidate is compared with the threshold of the condition, or with its range.
  void add(const Condition& condition, const Candidate& of, double value);
  /// `value` is compared with a multiple of `other`.
  void addRatio(const Condition& condition, const Candidate& of, double value, double other);
  /// Hands over what was collected.
  void finish();

 private:
  friend class Witness;
  struct Note {
    std::uint32_t threshold = 0;
    FragmentIndex fragment = 0;  ///< kNoFragment: a thing without any
    double value = 0;
  };
  static constexpr FragmentIndex kNoFragment = static_cast<FragmentIndex>(-1);

  void addOne(std::uint32_t threshold, const Candidate& of, double value);
  /// How far the nearest of the notes from this place on is from its threshold, as a share of it.
  double slackFrom(std::size_t place) const;

  const ReasoningState& state_;
  ThresholdMargins* margins_;
  std::vector<Note> notes_;
};

/// While one operand of `all` fails, the others do not matter, and so with one of `any` that holds. Of such operands
/// the notes of the surest are kept, of all others none. When there is none, all notes are kept.
class Witness {
 public:
  explicit Witness(TestNotes& notes) : notes_(notes), first_(notes.notes_.size()), from_(first_) {}

  /// An operand was evaluated. `decides`: it alone gives the outcome.
  void take(bool decides);
  /// Whether some operand decides and is so far from its thresholds that no surer one need be looked for.
  bool isSure() const { return decides_ && slack_ >= kEnough; }

 private:
  static constexpr double kEnough = 0.3;

  TestNotes& notes_;
  std::size_t first_, from_;
  bool decides_ = false;
  double slack_ = 0;
};

}  // namespace cluxel::rules
