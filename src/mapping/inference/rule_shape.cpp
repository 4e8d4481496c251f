// SPDX-License-Identifier: Apache-2.0
// Walks the syntax tree of a rule once.
#include "mapping/inference/rule_shape.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "mapping/inference/bound_variables.hpp"
#include "mapping/inference/rule_limits.hpp"
#include "sparql/syntax/parser.hpp"

namespace cluxel::mapping {

namespace {

using PathKind = ast::Path::Kind;
using Need = ReadPattern::Need;

/// Replaces sequences and inverses by patterns with hidden variables between them.
class PathExpansion {
 public:
  explicit PathExpansion(ast::VariableTable& variables) : variables_(variables) {}
  void group(ast::GroupPattern& group) {
    for (ast::PatternElement& element : group.elements) {
      if (auto* block = std::get_if<ast::TriplesBlock>(&element.value)) triples(*block);
      forEachGroup(element, [this](ast::GroupPattern& inner) { this->group(inner); });
      if (auto* filter = std::get_if<ast::Filter>(&element.value)) expression(filter->condition);
      if (auto* inner = std::get_if<ast::SubSelect>(&element.value)) {
        auto select = std::make_shared<ast::Select>(*inner->select);
        this->group(select->where);
        inner->select = std::move(select);
      }
    }
  }

 private:
  void expression(ast::Expression& expression) {
    for (ast::Expression& argument : expression.arguments) this->expression(argument);
    if (!expression.pattern) return;
    auto pattern = std::make_shared<ast::GroupPattern>(*expression.pattern);
    group(*pattern);
    expression.pattern = std::move(pattern);
  }

  void triples(ast::TriplesBlock& block) {
    std::vector<ast::TriplePattern> expanded;
    for (const ast::TriplePattern& triple : block.triples) {
      if (triple.isPath())
        path(triple.subject, *triple.path, triple.object, expanded);
      else
        expanded.push_back(triple);
    }
    block.triples = std::move(expanded);
  }

  void path(const ast::PatternTerm& from, const ast::Path& path, const ast::PatternTerm& to,
            std::vector<ast::TriplePattern>& expanded) {
    if (path.kind == PathKind::Link) {
      expanded.push_back({from, {path.iri, path.at}, nullptr, to});
    } else if (path.kind == PathKind::Inverse) {
      this->path(to, path.parts[0], from, expanded);
    } else if (path.kind == PathKind::Sequence) {
      ast::PatternTerm at = from;
      for (std::size_t i = 0; i < path.parts.size(); ++i) {
        const ast::PatternTerm next = i + 1 == path.parts.size() ? to : between(path.at);
        this->path(at, path.parts[i], next, expanded);
        at = next;
      }
    } else {
      expanded.push_back({from, {}, std::make_shared<const ast::Path>(path), to});
    }
  }

  ast::PatternTerm between(ast::SourceOffset at) {
    variables_.push_back({"_:step" + std::to_string(variables_.size()), true});
    return {static_cast<ast::VariableIndex>(variables_.size() - 1), at};
  }

  ast::VariableTable& variables_;
};

/// Whether the path, or some part of it, may have no step.
bool mayHaveNoStep(const ast::Path& path) {
  return path.kind == PathKind::ZeroOrMore || path.kind == PathKind::ZeroOrOne ||
         std::any_of(path.parts.begin(), path.parts.end(), mayHaveNoStep);
}

/// The properties that a path walks; false when they cannot be told.
bool addLinks(const ast::Path& path, std::vector<Term>& links) {
  if (path.kind == PathKind::NegatedSet) return false;
  if (path.kind == PathKind::Link) links.push_back(path.iri);
  return std::all_of(path.parts.begin(), path.parts.end(),
                     [&](const ast::Path& part) { return addLinks(part, links); });
}

class ShapeWalk {
 public:
  explicit ShapeWalk(RuleShape& shape) : shape_(shape) {}

  void run() {
    PathExpansion(shape_.query.variables).group(shape_.query.select.where);
    hideDerivations(shape_.query);
    if (!shape_.query.dataset.empty()) return never("it names its graphs");
    if (asksExists(shape_.query.select)) return never("it asks EXISTS where it groups, selects or orders");
    const ast::GroupPattern* body = bodyOf();
    group(body != nullptr ? *body : shape_.query.select.where, body != nullptr ? Need::Always : Need::No);
    if (body != nullptr) mentionKey(*body);
    shape_.is_monotone = shape_.following == RuleShape::Following::ByKey && !shape_.is_grouped &&
                         std::none_of(shape_.reads.begin(), shape_.reads.end(),
                                      [](const ReadPattern& read) { return read.need == Need::No; });
  }

 private:
  void never(const std::string& reason) {
    shape_.following = RuleShape::Following::Never;
    shape_.reason = reason;
  }
  void asWhole(const std::string& reason) {
    if (shape_.following != RuleShape::Following::ByKey) return;
    shape_.following = RuleShape::Following::AsWhole;
    shape_.reason = reason;
  }

  static const ast::SubSelect* subSelectIn(const ast::PatternElement& element) {
    if (const auto* inner = std::get_if<ast::SubSelect>(&element.value)) return inner;
    const auto* group = std::get_if<ast::GroupPattern>(&element.value);
    return group != nullptr && group->elements.size() == 1 ? subSelectIn(group->elements.front()) : nullptr;
  }

  /// The group with the patterns: the whole WHERE clause, or that of its only sub-select. Null when the rule has
  /// neither shape.
  const ast::GroupPattern* bodyOf() {
    const ast::Select& select = shape_.query.select;
    const ast::SolutionModifiers& modifiers = select.modifiers;
    if (select.grouped || select.values || modifiers.limit || modifiers.offset) {
      asWhole("it groups, cuts or takes values outside of its patterns");
      return nullptr;
    }
    const ast::SubSelect* grouped = nullptr;
    for (const ast::PatternElement& element : select.where.elements)
      if (const ast::SubSelect* inner = subSelectIn(element)) grouped = inner;
    if (grouped == nullptr) return &select.where;
    return isGroupedByKey(select.where, *grouped->select) ? &grouped->select->where : nullptr;
  }

  bool isGroupedByKey(const ast::GroupPattern& around, const ast::Select& inner) {
    for (const ast::PatternElement& element : around.elements) {
      const auto* filter = std::get_if<ast::Filter>(&element.value);
      const auto* bind = std::get_if<ast::Bind>(&element.value);
      const bool is_computed =
          (bind != nullptr && !hasExists(bind->expression)) || (filter != nullptr && !hasExists(filter->condition));
      if (is_computed || (subSelectIn(element) != nullptr && subSelectIn(element)->select.get() == &inner)) continue;
      asWhole("it joins a sub-select with other patterns");
      return false;
    }
    const auto& keys = inner.modifiers.group_by;
    const bool is_keyed = inner.grouped && !keys.empty() && !keys.front().as &&
                          keys.front().expression.kind == ast::Expression::Kind::Variable;
    if (!is_keyed || inner.values || inner.modifiers.limit || inner.modifiers.offset) {
      asWhole(inner.grouped && keys.empty() ? "it aggregates over the map"
                                            : "its sub-select has no variable to group by");
      return false;
    }
    if (std::any_of(inner.modifiers.having.begin(), inner.modifiers.having.end(), hasExists) ||
        std::any_of(inner.projection.begin(), inner.projection.end(),
                    [](const auto& column) { return column.expression && hasExists(*column.expression); })) {
      asWhole("its sub-select asks EXISTS of groups");
      return false;
    }
    shape_.is_grouped = true;
    shape_.key = keys.front().expression.variable;
    return true;
  }

  /// The variables of the triple patterns of a group itself, in order.
  static std::vector<ast::VariableIndex> endsIn(const ast::GroupPattern& group) {
    std::vector<ast::VariableIndex> ends;
    for (const ast::PatternElement& element : group.elements)
      if (const auto* block = std::get_if<ast::TriplesBlock>(&element.value))
        for (const ast::TriplePattern& triple : block->triples)
          for (const ast::PatternTerm* end : {&triple.subject, &triple.object})
            if (end->isVariable()) ends.push_back(end->variable());
    return ends;
  }

  /// The variables that triple patterns hold in every branch of a UNION of the group.
  static std::vector<ast::VariableIndex> endsInAllBranches(const ast::GroupPattern& group) {
    std::vector<ast::VariableIndex> ends;
    for (const ast::PatternElement& element : group.elements) {
      const auto* either = std::get_if<ast::UnionPattern>(&element.value);
      if (either == nullptr) continue;
      for (const ast::VariableIndex end : endsIn(either->branches.front())) {
        const auto holds = [end](const ast::GroupPattern& branch) {
          const auto some = endsIn(branch);
          return std::find(some.begin(), some.end(), end) != some.end();
        };
        if (std::all_of(either->branches.begin(), either->branches.end(), holds)) ends.push_back(end);
      }
    }
    return ends;
  }

  /// Chooses the key of a rule that does not group, and tells the patterns with the key from others.
  void mentionKey(const ast::GroupPattern& body) {
    std::vector<ast::VariableIndex> subjects = endsIn(body);
    if (subjects.empty()) subjects = endsInAllBranches(body);
    if (!shape_.is_grouped && !subjects.empty()) shape_.key = subjects.front();
    if (std::find(subjects.begin(), subjects.end(), shape_.key) == subjects.end())
      return asWhole("no triple pattern holds the variable of its solutions in every one of them");
    const auto is_key = [&](const ast::PatternTerm& end) { return end.isVariable() && end.variable() == shape_.key; };
    for (ReadPattern& read : shape_.reads) {
      read.has_key = is_key(read.triple.subject) || is_key(read.triple.object);
      const bool has_variable = read.triple.subject.isVariable() || read.triple.object.isVariable();
      if (!read.has_key && (read.need == Need::No || !has_variable))
        asWhole("what it excludes or may lack is not about ?" + shape_.query.variables[shape_.key].name);
    }
    if (!isLocalTo(shape_.key, body))
      asWhole("it has OPTIONAL, MINUS, BIND or EXISTS where ?" + shape_.query.variables[shape_.key].name +
              " is not bound yet");
    shape_.is_plain = shape_.is_plain && !shape_.is_grouped;
  }

  void triples(const ast::TriplesBlock& block, Need need) {
    for (const ast::TriplePattern& triple : block.triples) {
      ReadPattern read;
      read.triple = triple;
      read.need = need;
      if (need == Need::InABranch) read.branch = branch_;
      if (triple.isPath()) {
        shape_.is_plain = false;
        if (!addLinks(*triple.path, read.links)) return never("a path of it walks any property");
        if (mayHaveNoStep(*triple.path)) asWhole("a path of it may have no step");
      } else if (triple.predicate.isVariable()) {
        return never("a property of it is a variable");
      }
      shape_.reads.push_back(std::move(read));
    }
  }

  void expression(const ast::Expression& expression) {
    for (const ast::Expression& argument : expression.arguments) this->expression(argument);
    if (!expression.pattern) return;
    shape_.is_plain = false;
    group(*expression.pattern, Need::No);
  }

  void group(const ast::GroupPattern& pattern, Need need) {
    bool has_bind = false;
    for (const ast::PatternElement& element : pattern.elements) {
      // A row does not name what BIND saw before the triples behind it.
      if (has_bind && std::holds_alternative<ast::TriplesBlock>(element.value)) shape_.is_plain = false;
      has_bind = has_bind || std::holds_alternative<ast::Bind>(element.value);
      this->element(element, need);
    }
  }

  void element(const ast::PatternElement& element, Need need) {
    if (const auto* block = std::get_if<ast::TriplesBlock>(&element.value)) return triples(*block, need);
    if (const auto* filter = std::get_if<ast::Filter>(&element.value)) return expression(filter->condition);
    if (const auto* bind = std::get_if<ast::Bind>(&element.value)) {
      if (hasExists(bind->expression)) asWhole("it binds the outcome of EXISTS");
      return expression(bind->expression);
    }
    if (std::holds_alternative<ast::InlineData>(element.value)) return;
    shape_.is_plain = false;
    if (const auto* inner = std::get_if<ast::GroupPattern>(&element.value)) return group(*inner, need);
    if (const auto* optional = std::get_if<ast::OptionalPattern>(&element.value))
      return group(optional->group, Need::No);
    if (const auto* minus = std::get_if<ast::MinusPattern>(&element.value)) return group(minus->group, Need::No);
    if (const auto* either = std::get_if<ast::UnionPattern>(&element.value)) return branches(*either, need);
    if (const auto* inner = std::get_if<ast::SubSelect>(&element.value)) {
      asWhole("it has a sub-select within another pattern");
      return group(inner->select->where, Need::No);
    }
    never("it reads a graph or a service by name");
  }

  void branches(const ast::UnionPattern& either, Need need) {
    const std::size_t number = shape_.branches.size();
    if (need == Need::Always) shape_.branches.push_back(either.branches.size());
    for (std::size_t i = 0; i < either.branches.size(); ++i) {
      const auto around = std::exchange(branch_, std::nullopt);
      if (need == Need::Always) branch_ = UnionBranch{number, i};
      group(either.branches[i], need == Need::No ? need : Need::InABranch);
      branch_ = around;
    }
  }

  RuleShape& shape_;
  std::optional<UnionBranch> branch_;  ///< around the patterns at hand
};

}  // namespace

RuleShape shapeOf(const NamedText& rule) {
  sparql::SparqlParseOptions options;
  options.file = rule.name;
  RuleShape shape;
  shape.rule = rule;
  shape.query = sparql::parseQuery(rule.text, options);
  shape.is_plain = true;
  ShapeWalk(shape).run();
  return shape;
}

}  // namespace cluxel::mapping
