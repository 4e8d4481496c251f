// SPDX-License-Identifier: Apache-2.0
// Functions on RDF terms: kind tests, accessors and constructors.
#include <algorithm>
#include <array>
#include <cstdio>

#include "base/ascii.hpp"
#include "base/content_hash.hpp"
#include "rdf/iri.hpp"
#include "rdf/map_iris.hpp"
#include "sparql/functions/function_bodies.hpp"
#include "sparql/syntax/iri_resolution.hpp"
#include "sparql/values/comparison.hpp"
#include "sparql/values/datatype.hpp"

namespace cluxel::sparql {
namespace {

using Type = Value::Type;

std::string randomUuid(FunctionContext& context) {
  const std::uint64_t high = (context.random() & ~0xF000ull) | 0x4000ull;
  const std::uint64_t low = (context.random() & ~(3ull << 62)) | (2ull << 62);
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%08llx-%04llx-%04llx-%04llx-%012llx",
                static_cast<unsigned long long>(high >> 32), static_cast<unsigned long long>(high >> 16 & 0xFFFF),
                static_cast<unsigned long long>(high & 0xFFFF), static_cast<unsigned long long>(low >> 48),
                static_cast<unsigned long long>(low & 0xFFFF'FFFF'FFFFull));
  return text.data();
}

bool isLanguageTag(std::string_view tag) {
  // Simplified RFC 5646: letters, then subtags of up to eight letters and digits.
  std::size_t length = 0;
  bool first = true;
  for (const char c : tag) {
    if (c == '-') {
      if (length == 0) return false;
      length = 0;
      first = false;
    } else if (!(isAsciiLetter(c) || (isAsciiDigit(c) && !first)) || ++length > 8) {
      return false;
    }
  }
  return length > 0;
}

}  // namespace

std::string FunctionContext::freshLabel() {
  return "q" + label_prefix + std::to_string(++fresh_labels);
}

Value strFunction(Arguments arguments, FunctionContext& context) {
  const Value& value = arguments[0];
  if (value.type == Type::String) return value;
  if (value.type == Type::Blank) return {};
  return Value::string(context.terms.textOf(value));
}

Value langFunction(Arguments arguments, FunctionContext& context) {
  if (!arguments[0].isLiteral()) return {};
  return Value::string(context.terms.languageOf(arguments[0]));
}

Value langMatchesFunction(Arguments arguments, FunctionContext& context) {
  if (arguments[0].type != Type::String || arguments[1].type != Type::String) return {};
  const std::string tag = lowerCase(context.terms.textOf(arguments[0]));
  const std::string range = lowerCase(context.terms.textOf(arguments[1]));
  if (range == "*") return Value::boolean(!tag.empty());
  return Value::boolean(tag == range || (!range.empty() && tag.starts_with(range + "-")));
}

Value datatypeFunction(Arguments arguments, FunctionContext& context) {
  if (!arguments[0].isLiteral()) return {};
  return Value::iri(context.terms.datatypeOf(arguments[0]));
}

Value iriFunction(Arguments arguments, FunctionContext& context) {
  const Value& value = arguments[0];
  if (value.type == Type::Iri) return value;
  if (value.type != Type::String) return {};
  const std::string text = context.terms.textOf(value);
  if (!rdf::hasIriCharactersOnly(text)) return {};
  if (!context.base_iri.empty()) return Value::iri(resolveIri(text, context.base_iri));
  return isAbsoluteIri(text) ? Value::iri(resolveIri(text, {})) : Value{};  // no RDF file could name a relative IRI
}

Value bnodeFunction(Arguments arguments, FunctionContext& context) {
  if (arguments.empty()) return Value::blank(context.freshLabel());
  if (arguments[0].type != Type::String) return {};
  if (context.labels_of_solution != context.solution) {
    context.solution_labels.clear();
    context.labels_of_solution = context.solution;
  }
  std::string& label = context.solution_labels[context.terms.textOf(arguments[0])];
  if (label.empty()) label = context.freshLabel();
  return Value::blank(label);
}

Value uuidFunction(Arguments, FunctionContext& context) {
  return Value::iri("urn:uuid:" + randomUuid(context));
}
Value strUuidFunction(Arguments, FunctionContext& context) {
  return Value::string(randomUuid(context));
}

Value strLangFunction(Arguments arguments, FunctionContext& context) {
  if (arguments[0].type != Type::String || arguments[1].type != Type::String) return {};
  const std::string tag = lowerCase(context.terms.textOf(arguments[1]));
  if (!isLanguageTag(tag)) return {};
  return Value::langString(context.terms.textOf(arguments[0]), tag);
}

Value strDtFunction(Arguments arguments, FunctionContext& context) {
  if (arguments[0].type != Type::String || arguments[1].type != Type::Iri) return {};
  const std::string datatype = context.terms.textOf(arguments[1]);
  if (datatype == rdf::vocabulary::rdf("langString")) return {};
  const Term term = Term::literal(context.terms.textOf(arguments[0]), datatype);
  return context.terms.valueOf(context.terms.intern(term));
}

Value sameTermFunction(Arguments arguments, FunctionContext& context) {
  return Value::boolean(sameTerm(arguments[0], arguments[1], context.terms));
}

Value isIriFunction(Arguments arguments, FunctionContext&) {
  return Value::boolean(arguments[0].type == Type::Iri);
}
Value isBlankFunction(Arguments arguments, FunctionContext&) {
  return Value::boolean(arguments[0].type == Type::Blank);
}
Value isLiteralFunction(Arguments arguments, FunctionContext&) {
  return Value::boolean(arguments[0].isLiteral());
}
Value isNumericFunction(Arguments arguments, FunctionContext&) {
  return Value::boolean(arguments[0].isNumeric());
}

Value newObjectFunction(Arguments arguments, FunctionContext& context) {
  std::vector<std::string> members;
  for (const Value& value : arguments) {
    if (value.type != Type::Iri) return {};
    members.push_back(context.terms.textOf(value));
  }
  const std::string class_iri = members.front();
  members.erase(members.begin());
  std::sort(members.begin(), members.end());
  members.erase(std::unique(members.begin(), members.end()), members.end());
  ContentHasher hasher;
  hasher.addText("object").addText(class_iri);
  for (const std::string& member : members) hasher.addText(member);
  return Value::iri(rdf::iriOfObject(hasher.finish()));
}

}  // namespace cluxel::sparql
