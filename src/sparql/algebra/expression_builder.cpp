// SPDX-License-Identifier: Apache-2.0
// Translates expressions: resolves functions, checks argument counts, extracts aggregates.
#include "base/nearest_name.hpp"
#include "cluxel/error.hpp"
#include "sparql/algebra/algebra_builder.hpp"
#include "sparql/exec/guard.hpp"
#include "sparql/functions/regex_cache.hpp"

namespace cluxel::sparql {
namespace {

using Written = ast::Expression::Kind;

std::optional<Expr::Kind> operatorKind(Written kind) {
  switch (kind) {
    case Written::Or:
      return Expr::Kind::Or;
    case Written::And:
      return Expr::Kind::And;
    case Written::Not:
      return Expr::Kind::Not;
    case Written::Equal:
      return Expr::Kind::Equal;
    case Written::NotEqual:
      return Expr::Kind::NotEqual;
    case Written::Less:
      return Expr::Kind::Less;
    case Written::Greater:
      return Expr::Kind::Greater;
    case Written::LessEqual:
      return Expr::Kind::LessEqual;
    case Written::GreaterEqual:
      return Expr::Kind::GreaterEqual;
    case Written::In:
      return Expr::Kind::In;
    case Written::NotIn:
      return Expr::Kind::NotIn;
    case Written::Add:
      return Expr::Kind::Add;
    case Written::Subtract:
      return Expr::Kind::Subtract;
    case Written::Multiply:
      return Expr::Kind::Multiply;
    case Written::Divide:
      return Expr::Kind::Divide;
    case Written::Negate:
      return Expr::Kind::Negate;
    case Written::Plus:
      return Expr::Kind::Plus;
    default:
      return std::nullopt;
  }
}

Expr ofKind(Expr::Kind kind, ast::SourceOffset at) {
  Expr expression;
  expression.kind = kind;
  expression.at = at;
  return expression;
}

}  // namespace

Expr AlgebraBuilder::expression(const ast::Expression& written, Scope& scope, const SlotSet& visible) {
  if (options_.guard != nullptr) options_.guard->spend(sizeof(Expr));
  switch (written.kind) {
    case Written::Variable: {
      Expr result = variable(written, scope, visible);
      if (result.kind == Expr::Kind::Unbound)
        warn(written.at, "?" + variables_[written.variable].name + " has no value here: no pattern binds it",
             "bind it by a pattern, BIND or VALUES; the parameters of a shipped question have values when it is asked "
             "by its name");
      return result;
    }
    case Written::Constant: {
      Expr result = ofKind(Expr::Kind::Constant, written.at);
      result.constant = terms_.valueOf(terms_.intern(written.term));
      return result;
    }
    case Written::Exists:
    case Written::NotExists:
      return exists(written, scope, visible);
    case Written::Aggregate:
      return aggregate(written);
    case Written::Call:
    case Written::Function:
      return call(written, scope, visible);
    default:
      break;
  }
  Expr result = ofKind(*operatorKind(written.kind), written.at);
  for (const ast::Expression& argument : written.arguments) {
    result.arguments.push_back(expression(argument, scope, visible));
  }
  return result;
}

Expr AlgebraBuilder::variable(const ast::Expression& written, Scope& scope, const SlotSet& visible) {
  const Slot slot = slotOf(written.variable, scope);
  const bool seen = visible.has(slot) || scope.substituted.has(slot) || isParameter(slot);
  Expr result = ofKind(seen ? Expr::Kind::Slot : Expr::Kind::Unbound, written.at);
  if (seen) result.slot = slot;
  return result;
}

Expr AlgebraBuilder::call(const ast::Expression& written, Scope& scope, const SlotSet& visible) {
  Expr result = ofKind(Expr::Kind::Call, written.at);
  if (written.kind == Written::Function) {
    result.function = findFunction(written.term.text);
    if (result.function == nullptr) return unknownFunction(written, scope, visible);
  } else if (written.builtin == ast::Builtin::Bound) {
    const Expr tested = variable(written.arguments[0], scope, visible);
    result.kind = tested.kind == Expr::Kind::Slot ? Expr::Kind::Bound : Expr::Kind::Constant;
    result.slot = tested.slot;
    if (result.kind == Expr::Kind::Constant) result.constant = Value::boolean(false);
    return result;
  } else if (written.builtin == ast::Builtin::Coalesce) {
    result.kind = Expr::Kind::Coalesce;
  } else if (written.builtin == ast::Builtin::If) {
    result.kind = Expr::Kind::If;
  } else {
    result.function = findBuiltin(written.builtin);
  }
  if (result.function != nullptr) checkCall(written, *result.function);
  for (const ast::Expression& argument : written.arguments) {
    const bool may_lack_value = result.kind == Expr::Kind::Coalesce && argument.kind == Written::Variable;
    result.arguments.push_back(may_lack_value ? variable(argument, scope, visible)
                                              : expression(argument, scope, visible));
  }
  return result;
}

/// A call of a function that nobody has is an error of its expression, as the specification says: FILTER drops the row,
/// COALESCE goes on. In rules it is an error of the rule.
Expr AlgebraBuilder::unknownFunction(const ast::Expression& written, Scope& scope, const SlotSet& visible) {
  const std::string message = "unknown function <" + written.term.text + ">";
  const std::string hint = suggestion(written.term.text, functionIris());
  if (options_.refuse_volatile) fail(written.at, message, hint);
  warn(written.at, message + ": an expression that calls it is an error", hint);
  for (const ast::Expression& argument : written.arguments) expression(argument, scope, visible);
  return ofKind(Expr::Kind::Unbound, written.at);
}

void AlgebraBuilder::checkRegex(const ast::Expression& written) {
  const std::size_t flags_at = written.builtin == ast::Builtin::Replace ? 3 : 2;
  const auto text = [&](std::size_t i) {
    const bool is_constant = i < written.arguments.size() && written.arguments[i].kind == Written::Constant;
    return is_constant ? std::optional(written.arguments[i].term.text) : std::nullopt;
  };
  const bool has_flags = written.arguments.size() > flags_at;
  if (!text(1) || (has_flags && !text(flags_at))) return;
  const std::string fault = regexFault(*text(1), has_flags ? *text(flags_at) : "");
  if (!fault.empty())
    warn(written.arguments[1].at, "\"" + *text(1) + "\" is no regular expression: " + fault,
         "the expression is an error for every row; the flag \"q\" takes the pattern as plain text");
}

void AlgebraBuilder::checkCall(const ast::Expression& written, const FunctionEntry& function) {
  const std::size_t count = written.arguments.size();
  if (count < function.min_arguments || count > function.max_arguments) {
    const std::string expected_count = function.min_arguments == function.max_arguments
                                           ? std::to_string(function.min_arguments)
                                           : "at least " + std::to_string(function.min_arguments);
    fail(written.at, std::string(function.name) + " takes " + expected_count + " argument" +
                         (expected_count == "1" ? "" : "s") + ", not " + std::to_string(count));
  }
  if (written.builtin == ast::Builtin::Regex || written.builtin == ast::Builtin::Replace) checkRegex(written);
  is_volatile_ = is_volatile_ || function.is_volatile;
  if (function.is_volatile && options_.refuse_volatile) {
    fail(written.at, std::string(function.name) + " is refused here: a rule's result must follow from the map alone",
         "use clx:newObject for new objects");
  }
}

Expr AlgebraBuilder::exists(const ast::Expression& written, Scope& scope, const SlotSet& visible) {
  Expr result = ofKind(written.kind == Written::Exists ? Expr::Kind::Exists : Expr::Kind::NotExists, written.at);
  // Variables that are not bound by the outer solution are local to the pattern.
  Scope inner = scope;
  inner.substituted.add(visible);
  for (Slot& slot : inner.slot_of) {
    if (slot != kNoSlot && !visible.has(slot) && !scope.substituted.has(slot) && !isParameter(slot)) slot = kNoSlot;
  }
  result.pattern = group(*written.pattern, inner);
  result.exists = exists_count_++;
  return result;
}

Expr AlgebraBuilder::aggregate(const ast::Expression& written) {
  if (aggregation_.found == nullptr) fail(written.at, "an aggregate is not allowed here");
  AggregateSpec spec;
  spec.function = written.aggregate;
  spec.distinct = written.distinct;
  spec.separator = written.separator;
  if (!written.arguments.empty()) {
    const Aggregation outer = aggregation_;
    aggregation_ = {};  // aggregates cannot be nested
    spec.argument = expression(written.arguments[0], *outer.scope, *outer.inner_visible);
    aggregation_ = outer;
  }
  spec.result = freshSlot("." + std::string(ast::nameOf(written.aggregate)));
  Expr result = ofKind(Expr::Kind::Slot, written.at);
  result.slot = spec.result;
  aggregation_.found->push_back(std::move(spec));
  return result;
}

}  // namespace cluxel::sparql
