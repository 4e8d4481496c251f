// SPDX-License-Identifier: Apache-2.0
// A stack of notes: an operand's are on top until it is known whether they matter.
#include "rules/propose/test_notes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rules/decide/threshold_margins.hpp"

namespace cluxel::rules {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

void TestNotes::add(const Condition& condition, const Candidate& of, double value) {
  if (margins_ == nullptr || condition.threshold == 0) return;
  addOne(condition.threshold, of, value);
  if (condition.upper_threshold != 0) addOne(condition.upper_threshold, of, value);
}

void TestNotes::addRatio(const Condition& condition, const Candidate& of, double value, double other) {
  if (margins_ == nullptr || condition.threshold == 0) return;
  for (const double quotient : quotientsToNote(value, other, condition.ratio))
    addOne(condition.threshold, of, quotient);
}

void TestNotes::addOne(std::uint32_t threshold, const Candidate& of, double value) {
  notes_.push_back({threshold, of.fragments.empty() ? kNoFragment : of.fragments.front(), value});
}

double TestNotes::slackFrom(std::size_t place) const {
  constexpr double kSmallest = 0.05;  // shares of thresholds near 0 tell nothing
  double slack = kInfinity;
  for (; place < notes_.size(); ++place) {
    const double threshold = state_.rules.thresholds[notes_[place].threshold - 1].value;
    slack = std::min(slack, std::abs(notes_[place].value - threshold) / std::max(std::abs(threshold), kSmallest));
  }
  return slack;
}

void TestNotes::finish() {
  for (const Note& note : notes_)
    if (note.fragment == kNoFragment)
      margins_->noteEverywhere(note.threshold, note.value);
    else
      margins_->note(state_.fragments[note.fragment].primitive, note.threshold, note.value);
  notes_.clear();
}

void Witness::take(bool decides) {
  std::vector<TestNotes::Note>& notes = notes_.notes_;
  const double slack = decides ? notes_.slackFrom(from_) : 0;
  if (decides && (!decides_ || slack > slack_)) {
    notes.erase(notes.begin() + static_cast<std::ptrdiff_t>(first_),
                notes.begin() + static_cast<std::ptrdiff_t>(from_));
    decides_ = true;
    slack_ = slack;
  } else if (decides_) {
    notes.resize(from_);
  }
  from_ = notes.size();
}

}  // namespace cluxel::rules
