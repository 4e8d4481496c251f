// SPDX-License-Identifier: Apache-2.0
// The design of a rule's regression: which numbers of the rule file are parameters, and how they add up to a
// candidate's log-odds. Private to evidence_fit.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "rules/language/rule_set.hpp"
#include "tasks/rule_fitting/candidate_examples.hpp"
#include "tasks/rule_fitting/round_number.hpp"

namespace cluxel::tasks::fitting {

using Row = std::vector<std::pair<std::size_t, double>>;  ///< parameter, factor

/// Where a number stands: numbers of a definition that is used several times have one place.
using Place = std::tuple<std::string, std::size_t, std::size_t>;

inline Place placeOf(const SourceLocation& at) {
  return {at.file, at.line, at.column};
}

/// Calls `see` with the place of each number that can be fitted.
template <typename See>
void forEachNumber(const rules::Rule& rule, const See& see) {
  const auto seeLines = [&](const std::vector<rules::EvidenceLine>& lines) {
    for (const rules::EvidenceLine& line : lines) {
      if (line.kind != rules::EvidenceLine::Kind::Curve) see(line.weight_at);
      for (const rules::EvidenceLine::Knot& knot : line.knots) see(knot.where);
    }
  };
  seeLines(rule.evidence);
  for (const rules::TreeNode& node : rule.nodes)
    if (const auto* accept = std::get_if<rules::AcceptLeaf>(&node.what)) {
      seeLines(accept->evidence);
      see(accept->confidence.high_at);
      if (!accept->confidence.ramps.empty()) see(accept->confidence.low_at);
    }
}

/// The rules in which each place has a part.
using UsersOf = std::map<Place, std::set<std::string>>;

inline UsersOf usersOf(const rules::RuleSet& rules) {
  UsersOf users;
  for (const rules::Rule& rule : rules.rules)
    forEachNumber(rule, [&](const SourceLocation& at) { users[placeOf(at)].insert(rule.id); });
  return users;
}

/// A parameter of the regression that stands for a number of the rule file.
struct Parameter {
  SourceLocation at;
  std::string what;
  double before = 0;
};

/// The design of one rule: how its numbers add up to a candidate's log-odds. A number that stands at one place, because
/// leaves share a definition, is one parameter. What other rules share too is kept as it is.
class Design {
 public:
  Design(const rules::Rule& rule, const UsersOf& users) : rule_(rule), users_(users) {
    for (const rules::EvidenceLine& line : rule.evidence) addLine(line);
    for (std::size_t node = 0; node < rule.nodes.size(); ++node)
      if (const auto* accept = std::get_if<rules::AcceptLeaf>(&rule.nodes[node].what)) {
        first_of_leaf_[node] = lines_.size();
        for (const rules::EvidenceLine& line : accept->evidence) addLine(line);
        addShift(node, *accept);
      }
  }

  /// The shift of the rule, those of its leaves, then the numbers of the evidence.
  std::size_t size() const { return 1 + shift_count_ + numbers_.size(); }
  std::size_t firstNumber() const { return 1 + shift_count_; }
  const std::vector<Parameter>& numbers() const { return numbers_; }
  const std::map<std::size_t, std::size_t>& shifts() const { return shift_of_leaf_; }
  /// Places that other rules share, each once.
  const std::set<Place>& keptPlaces() const { return kept_; }

  /// The factors of a candidate; what kept numbers add goes into `offset`.
  Row rowOf(const CandidateExample& example, double& offset) const {
    Row row;
    if (const auto shift = shift_of_leaf_.find(example.leaf); shift != shift_of_leaf_.end())
      row = {{0, 1.0}, {shift->second, 1.0}};
    const std::size_t shared = rule_.evidence.size();
    for (std::size_t i = 0; i < example.values.size(); ++i) {
      const std::size_t line = i < shared ? i : first_of_leaf_.at(example.leaf) + i - shared;
      if (example.values[i]) addTo(row, line, *example.values[i], offset);
    }
    return row;
  }

 private:
  bool isKept(const SourceLocation& at) {
    return users_.at(placeOf(at)).size() > 1 && (kept_.insert(placeOf(at)), true);
  }

  /// Leaves whose confidence stands at one place share its shift; a leaf whose confidence is kept has none.
  void addShift(std::size_t node, const rules::AcceptLeaf& accept) {
    const bool low_kept = !accept.confidence.ramps.empty() && isKept(accept.confidence.low_at);
    if (isKept(accept.confidence.high_at) || low_kept) return;
    const auto known = shift_of_place_.try_emplace(placeOf(accept.confidence.high_at), 1 + shift_count_);
    shift_count_ += known.second ? 1 : 0;
    shift_of_leaf_[node] = known.first->second;
  }

  void addLine(const rules::EvidenceLine& line) {
    lines_.push_back(&line);
    const std::string what = describe(line);
    std::vector<Term>& terms = terms_.emplace_back();
    if (line.kind != rules::EvidenceLine::Kind::Curve)
      return terms.push_back(termOf(line.weight_at, what, line.weight));
    for (const rules::EvidenceLine::Knot& knot : line.knots)
      terms.push_back(termOf(knot.where, what + " at " + sixDigitText(knot.at), knot.log_odds));
  }

  /// A number of a line: its parameter, or its value when it is kept.
  struct Term {
    std::optional<std::size_t> number;
    double kept = 0;
  };

  Term termOf(const SourceLocation& at, const std::string& what, double before) {
    if (isKept(at)) return {std::nullopt, before};
    const auto known = number_of_place_.try_emplace(placeOf(at), numbers_.size());
    if (known.second) numbers_.push_back({at, what, before});
    return {known.first->second, 0};
  }

  void addTerm(Row& row, const Term& term, double factor, double& offset) const {
    if (term.number)
      row.emplace_back(firstNumber() + *term.number, factor);
    else
      offset += factor * term.kept;
  }

  void addTo(Row& row, std::size_t number, double value, double& offset) const {
    const rules::EvidenceLine& line = *lines_[number];
    const std::vector<Term>& terms = terms_[number];
    if (line.kind == rules::EvidenceLine::Kind::Test) return addTerm(row, terms.front(), value, offset);
    if (line.kind == rules::EvidenceLine::Kind::Bell) {
      const double distance = (value - line.about) / line.spread;
      return addTerm(row, terms.front(), std::exp(-distance * distance / 2), offset);
    }
    const auto& knots = line.knots;
    const auto above = std::find_if(knots.begin(), knots.end(), [&](const auto& knot) { return knot.at >= value; });
    const auto i = static_cast<std::size_t>(above - knots.begin());
    if (i == 0 || i == knots.size()) return addTerm(row, terms[std::min(i, knots.size() - 1)], 1.0, offset);
    const double share = (value - knots[i - 1].at) / (knots[i].at - knots[i - 1].at);
    addTerm(row, terms[i - 1], 1 - share, offset);
    addTerm(row, terms[i], share, offset);
  }

  const rules::Rule& rule_;
  const UsersOf& users_;
  std::vector<const rules::EvidenceLine*> lines_;
  std::vector<std::vector<Term>> terms_;                              ///< parallel to lines_
  std::map<std::size_t, std::size_t> first_of_leaf_, shift_of_leaf_;  ///< by node
  std::map<Place, std::size_t> shift_of_place_, number_of_place_;
  std::size_t shift_count_ = 0;
  std::set<Place> kept_;
  std::vector<Parameter> numbers_;
};

}  // namespace cluxel::tasks::fitting
