// SPDX-License-Identifier: Apache-2.0
// String functions. Lengths and positions count code points; case mapping is by Unicode.
#include <unicode/bytestream.h>
#include <unicode/casemap.h>

#include <cmath>

#include "base/ascii.hpp"
#include "base/utf8.hpp"
#include "sparql/functions/function_bodies.hpp"

namespace cluxel::sparql {
namespace {

using Type = Value::Type;

/// A string with the language tag of `model`, if any.
Value like(const Value& model, std::string text, FunctionContext& context) {
  if (model.type == Type::LangString) return Value::langString(std::move(text), context.terms.languageOf(model));
  return Value::string(std::move(text));
}

/// Argument compatibility (section 17.4.3.1.2).
bool compatible(const Value& a, const Value& b, FunctionContext& context) {
  if (!a.isStringLike() || !b.isStringLike()) return false;
  if (b.type == Type::String) return true;
  return a.type == Type::LangString && context.terms.languageOf(a) == context.terms.languageOf(b);
}

enum class Case { Upper, Lower };

Value changeCase(const Value& value, Case to, FunctionContext& context) {
  if (!value.isStringLike()) return {};
  const std::string text = context.terms.textOf(value);
  std::string out;
  icu::StringByteSink<std::string> sink(&out);
  UErrorCode error = U_ZERO_ERROR;
  const icu::StringPiece piece(text.data(), static_cast<int32_t>(text.size()));
  if (to == Case::Upper) icu::CaseMap::utf8ToUpper("", 0, piece, sink, nullptr, error);
  if (to == Case::Lower) icu::CaseMap::utf8ToLower("", 0, piece, sink, nullptr, error);
  if (U_FAILURE(error)) return {};
  return like(value, std::move(out), context);
}

template <typename Test>
Value testTexts(Arguments arguments, FunctionContext& context, Test test) {
  if (!compatible(arguments[0], arguments[1], context)) return {};
  std::string scratch_a, scratch_b;
  return Value::boolean(
      test(context.terms.textOf(arguments[0], scratch_a), context.terms.textOf(arguments[1], scratch_b)));
}

}  // namespace

Value concatFunction(Arguments arguments, FunctionContext& context) {
  std::string text, scratch;
  bool same_language = !arguments.empty();
  std::size_t bytes = 0;
  for (const Value& value : arguments) {
    if (!value.isStringLike()) return {};
    bytes += context.terms.textOf(value, scratch).size();
    requireTextSize(bytes);
  }
  text.reserve(bytes);
  for (const Value& value : arguments) {
    text += context.terms.textOf(value, scratch);
    same_language = same_language && value.type == Type::LangString &&
                    context.terms.languageOf(value) == context.terms.languageOf(arguments[0]);
  }
  return same_language ? like(arguments[0], std::move(text), context) : Value::string(std::move(text));
}

Value strlenFunction(Arguments arguments, FunctionContext& context) {
  if (!arguments[0].isStringLike()) return {};
  std::string scratch;
  return Value::ofInteger(static_cast<std::int64_t>(countCodePoints(context.terms.textOf(arguments[0], scratch))));
}

Value ucaseFunction(Arguments arguments, FunctionContext& context) {
  return changeCase(arguments[0], Case::Upper, context);
}

Value lcaseFunction(Arguments arguments, FunctionContext& context) {
  return changeCase(arguments[0], Case::Lower, context);
}

Value encodeForUriFunction(Arguments arguments, FunctionContext& context) {
  if (!arguments[0].isStringLike()) return {};
  return Value::string(percentEncoded(context.terms.textOf(arguments[0])));
}

Value containsFunction(Arguments arguments, FunctionContext& context) {
  return testTexts(arguments, context,
                   [](std::string_view a, std::string_view b) { return a.find(b) != std::string_view::npos; });
}

Value strStartsFunction(Arguments arguments, FunctionContext& context) {
  return testTexts(arguments, context, [](std::string_view a, std::string_view b) { return a.starts_with(b); });
}

Value strEndsFunction(Arguments arguments, FunctionContext& context) {
  return testTexts(arguments, context, [](std::string_view a, std::string_view b) { return a.ends_with(b); });
}

Value strBeforeFunction(Arguments arguments, FunctionContext& context) {
  if (!compatible(arguments[0], arguments[1], context)) return {};
  const std::string text = context.terms.textOf(arguments[0]);
  const std::size_t at = text.find(context.terms.textOf(arguments[1]));
  if (at == std::string::npos) return Value::string({});
  return like(arguments[0], text.substr(0, at), context);
}

Value strAfterFunction(Arguments arguments, FunctionContext& context) {
  if (!compatible(arguments[0], arguments[1], context)) return {};
  const std::string text = context.terms.textOf(arguments[0]), part = context.terms.textOf(arguments[1]);
  const std::size_t at = text.find(part);
  if (at == std::string::npos) return Value::string({});
  return like(arguments[0], text.substr(at + part.size()), context);
}

Value substrFunction(Arguments arguments, FunctionContext& context) {
  const Value& source = arguments[0];
  if (!source.isStringLike() || !arguments[1].isNumeric()) return {};
  if (arguments.size() == 3 && !arguments[2].isNumeric()) return {};
  // fn:substring: code points whose 1-based position p has round(start) <= p < round(start) + round(length).
  const auto rounded = [](double value) { return std::floor(value + 0.5); };
  const double begin = rounded(arguments[1].number);
  const double end = arguments.size() == 3 ? begin + rounded(arguments[2].number) : HUGE_VAL;
  const std::string text = context.terms.textOf(source);
  std::string out;
  double position = 0;
  for (const char c : text) {
    if (!isUtf8Continuation(c)) ++position;
    if (position >= begin && position < end) out += c;
  }
  return like(source, std::move(out), context);
}

}  // namespace cluxel::sparql
