// SPDX-License-Identifier: Apache-2.0
// The words of a rule set's conditions and evidence, made once: every decision records some of them.
#pragma once

#include <string>
#include <unordered_map>

#include "rules/language/rule_set.hpp"

namespace cluxel::rules {

/// Valid as long as the rules. Thread-safe.
class RuleTexts {
 public:
  explicit RuleTexts(const RuleSet& rules);
  /// As describe(). Of one of the rules' own, the cost is a copy.
  std::string of(const Condition& condition) const { return found(condition); }
  std::string of(const EvidenceLine& line) const { return found(line); }

 private:
  void add(const Condition& condition);
  void add(const std::vector<EvidenceLine>& lines);
  template <typename Described>
  std::string found(const Described& what) const {
    const auto text = texts_.find(&what);
    return text != texts_.end() ? text->second : describe(what);
  }

  std::unordered_map<const void*, std::string> texts_;
};

}  // namespace cluxel::rules
