// SPDX-License-Identifier: Apache-2.0
// REGEX and REPLACE.
#include "sparql/functions/function_bodies.hpp"
#include "sparql/functions/regex_cache.hpp"

namespace cluxel::sparql {
namespace {

using Type = Value::Type;

const CompiledRegex* compiled(const Value& pattern, Arguments flags, FunctionContext& context) {
  if (pattern.type != Type::String || (!flags.empty() && flags[0].type != Type::String)) return nullptr;
  return context.regexes->find(context.terms.textOf(pattern), flags.empty() ? "" : context.terms.textOf(flags[0]));
}

}  // namespace

Value regexFunction(Arguments arguments, FunctionContext& context) {
  if (!arguments[0].isStringLike()) return {};
  const CompiledRegex* regex = compiled(arguments[1], arguments.subspan(2), context);
  if (regex == nullptr) return {};
  std::string scratch;
  return Value::boolean(regexMatches(*regex, context.terms.textOf(arguments[0], scratch)));
}

Value replaceFunction(Arguments arguments, FunctionContext& context) {
  if (!arguments[0].isStringLike() || arguments[2].type != Type::String) return {};
  const CompiledRegex* regex = compiled(arguments[1], arguments.subspan(3), context);
  if (regex == nullptr) return {};
  auto replaced = regexReplace(*regex, context.terms.textOf(arguments[0]), context.terms.textOf(arguments[2]));
  if (!replaced) return {};
  if (arguments[0].type == Type::LangString) {
    return Value::langString(std::move(*replaced), context.terms.languageOf(arguments[0]));
  }
  return Value::string(std::move(*replaced));
}

}  // namespace cluxel::sparql
