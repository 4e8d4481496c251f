// SPDX-License-Identifier: Apache-2.0
// A search from the key, and then from variables of known types, over patterns for which each solution has a triple.
#include "mapping/inference/key_steps.hpp"

#include <optional>
#include <set>

namespace cluxel::mapping {

namespace {

class StepSearch {
 public:
  explicit StepSearch(const RuleShape& shape) : shape_(shape) {
    for (const ReadPattern& read : shape.reads)
      for (const ast::PatternTerm* end : {&read.triple.subject, &read.triple.object})
        if (end->isVariable() && end->variable() != shape.key) others_.insert(end->variable());
  }

  std::map<ast::VariableIndex, std::vector<KeyStep>> run() {
    ends_.insert(shape_.key);
    searchFromEnds();
    for (const ReadPattern& read : shape_.reads)
      if (isAboutConstant(read) && !leads(read.triple.subject.variable())) {
        ends_.insert(read.triple.subject.variable());
        searchFromEnds();
      }
    return std::move(steps_);
  }

 private:
  static bool isAboutConstant(const ReadPattern& read) {
    return read.need == ReadPattern::Need::Always && read.triple.subject.isVariable() &&
           !read.triple.object.isVariable();
  }

  void searchFromEnds() {
    for (bool is_more = true; is_more;) {
      is_more = false;
      for (const ast::VariableIndex variable : others_) {
        if (leads(variable)) continue;
        std::vector<KeyStep> found = stepsFrom(variable);
        if (found.empty()) continue;
        steps_.emplace(variable, std::move(found));
        is_more = true;
      }
    }
  }

  bool leads(ast::VariableIndex variable) const { return ends_.contains(variable) || steps_.contains(variable); }

  std::optional<KeyStep> stepBy(std::size_t read, ast::VariableIndex from) const {
    const ast::TriplePattern& triple = shape_.reads[read].triple;
    if (triple.isPath() || !triple.subject.isVariable() || !triple.object.isVariable()) return std::nullopt;
    const ast::VariableIndex subject = triple.subject.variable(), object = triple.object.variable();
    if (subject == from && leads(object)) return KeyStep{read, false, object};
    if (object == from && leads(subject)) return KeyStep{read, true, subject};
    return std::nullopt;
  }

  std::vector<KeyStep> stepsFrom(ast::VariableIndex variable) const {
    std::vector<std::map<std::size_t, KeyStep>> by_branch(shape_.branches.size());  // of each UNION
    for (std::size_t read = 0; read < shape_.reads.size(); ++read) {
      const auto step = stepBy(read, variable);
      const ReadPattern& pattern = shape_.reads[read];
      if (step && pattern.need == ReadPattern::Need::Always) return {*step};
      if (step && pattern.branch) by_branch[pattern.branch->number].emplace(pattern.branch->branch, *step);
    }
    for (std::size_t number = 0; number < by_branch.size(); ++number) {
      if (by_branch[number].size() != shape_.branches[number]) continue;
      std::vector<KeyStep> steps;
      for (const auto& [branch, step] : by_branch[number]) steps.push_back(step);
      return steps;
    }
    return {};
  }

  const RuleShape& shape_;
  std::set<ast::VariableIndex> others_, ends_;
  std::map<ast::VariableIndex, std::vector<KeyStep>> steps_;
};

}  // namespace

std::map<ast::VariableIndex, std::vector<KeyStep>> stepsToKey(const RuleShape& shape) {
  return StepSearch(shape).run();
}

}  // namespace cluxel::mapping
