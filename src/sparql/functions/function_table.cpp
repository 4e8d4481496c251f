// SPDX-License-Identifier: Apache-2.0
// The table from keywords and IRIs to functions.
#include <array>

#include "rdf/vocabulary.hpp"
#include "sparql/functions/function_bodies.hpp"
#include "sparql/functions/regex_cache.hpp"
#include "sparql/geometry/geometry.hpp"

namespace cluxel::sparql {
namespace {

using ast::Builtin;

struct BuiltinEntry {
  Builtin builtin;
  FunctionEntry entry;
};

constexpr auto kBuiltins = std::to_array<BuiltinEntry>({
    {Builtin::Str, {"STR", 1, 1, strFunction}},
    {Builtin::Lang, {"LANG", 1, 1, langFunction}},
    {Builtin::LangMatches, {"LANGMATCHES", 2, 2, langMatchesFunction}},
    {Builtin::Datatype, {"DATATYPE", 1, 1, datatypeFunction}},
    {Builtin::Iri, {"IRI", 1, 1, iriFunction}},
    {Builtin::Bnode, {"BNODE", 0, 1, bnodeFunction, true}},
    {Builtin::Rand, {"RAND", 0, 0, randFunction, true}},
    {Builtin::Abs, {"ABS", 1, 1, absFunction}},
    {Builtin::Ceil, {"CEIL", 1, 1, ceilFunction}},
    {Builtin::Floor, {"FLOOR", 1, 1, floorFunction}},
    {Builtin::Round, {"ROUND", 1, 1, roundFunction}},
    {Builtin::Concat, {"CONCAT", 0, kAnyNumber, concatFunction}},
    {Builtin::Strlen, {"STRLEN", 1, 1, strlenFunction}},
    {Builtin::Ucase, {"UCASE", 1, 1, ucaseFunction}},
    {Builtin::Lcase, {"LCASE", 1, 1, lcaseFunction}},
    {Builtin::EncodeForUri, {"ENCODE_FOR_URI", 1, 1, encodeForUriFunction}},
    {Builtin::Contains, {"CONTAINS", 2, 2, containsFunction}},
    {Builtin::StrStarts, {"STRSTARTS", 2, 2, strStartsFunction}},
    {Builtin::StrEnds, {"STRENDS", 2, 2, strEndsFunction}},
    {Builtin::StrBefore, {"STRBEFORE", 2, 2, strBeforeFunction}},
    {Builtin::StrAfter, {"STRAFTER", 2, 2, strAfterFunction}},
    {Builtin::Year, {"YEAR", 1, 1, yearFunction}},
    {Builtin::Month, {"MONTH", 1, 1, monthFunction}},
    {Builtin::Day, {"DAY", 1, 1, dayFunction}},
    {Builtin::Hours, {"HOURS", 1, 1, hoursFunction}},
    {Builtin::Minutes, {"MINUTES", 1, 1, minutesFunction}},
    {Builtin::Seconds, {"SECONDS", 1, 1, secondsFunction}},
    {Builtin::Timezone, {"TIMEZONE", 1, 1, timezoneFunction}},
    {Builtin::Tz, {"TZ", 1, 1, tzFunction}},
    {Builtin::Now, {"NOW", 0, 0, nowFunction, true}},
    {Builtin::Uuid, {"UUID", 0, 0, uuidFunction, true}},
    {Builtin::StrUuid, {"STRUUID", 0, 0, strUuidFunction, true}},
    {Builtin::Md5, {"MD5", 1, 1, md5Function}},
    {Builtin::Sha1, {"SHA1", 1, 1, sha1Function}},
    {Builtin::Sha256, {"SHA256", 1, 1, sha256Function}},
    {Builtin::Sha384, {"SHA384", 1, 1, sha384Function}},
    {Builtin::Sha512, {"SHA512", 1, 1, sha512Function}},
    {Builtin::StrLang, {"STRLANG", 2, 2, strLangFunction}},
    {Builtin::StrDt, {"STRDT", 2, 2, strDtFunction}},
    {Builtin::SameTerm, {"SAMETERM", 2, 2, sameTermFunction}},
    {Builtin::IsIri, {"ISIRI", 1, 1, isIriFunction}},
    {Builtin::IsBlank, {"ISBLANK", 1, 1, isBlankFunction}},
    {Builtin::IsLiteral, {"ISLITERAL", 1, 1, isLiteralFunction}},
    {Builtin::IsNumeric, {"ISNUMERIC", 1, 1, isNumericFunction}},
    {Builtin::Regex, {"REGEX", 2, 3, regexFunction}},
    {Builtin::Substr, {"SUBSTR", 2, 3, substrFunction}},
    {Builtin::Replace, {"REPLACE", 3, 4, replaceFunction}},
});

constexpr auto kNamedFunctions = std::to_array<FunctionEntry>({
    {"https://w3id.org/cluxel/ontology#newObject", 2, kAnyNumber, newObjectFunction},
    {"http://www.opengis.net/def/function/geosparql/distance", 2, 3, geoDistanceFunction},
    {"http://www.opengis.net/def/function/geosparql/sfIntersects", 2, 2, sfIntersectsFunction},
    {"http://www.opengis.net/def/function/geosparql/sfDisjoint", 2, 2, sfDisjointFunction},
    {"http://www.opengis.net/def/function/geosparql/sfWithin", 2, 2, sfWithinFunction},
    {"http://www.opengis.net/def/function/geosparql/sfContains", 2, 2, sfContainsFunction},
    {"http://www.opengis.net/def/function/geosparql/sfTouches", 2, 2, sfTouchesFunction},
    {"http://www.opengis.net/def/function/geosparql/envelope", 1, 1, envelopeFunction},
});

// clang-format off
#define CLUXEL_CASTS(X) \
  X(string) X(boolean) X(integer) X(decimal) X(float) X(double) \
  X(dateTime) X(date) X(time) X(duration) X(dayTimeDuration) X(yearMonthDuration) \
  X(gYear) X(gYearMonth) X(gMonthDay) X(gDay) X(gMonth) X(int) X(long) X(short) X(byte) \
  X(nonNegativeInteger) X(positiveInteger) X(nonPositiveInteger) X(negativeInteger) \
  X(unsignedLong) X(unsignedInt) X(unsignedShort) X(unsignedByte)
// clang-format on
#define CLUXEL_CAST_BODY(name)                                       \
  Value cast_##name(Arguments arguments, FunctionContext& context) { \
    return castValue(#name, arguments[0], context);                  \
  }
#define CLUXEL_CAST_ENTRY(name) {"http://www.w3.org/2001/XMLSchema#" #name, 1, 1, cast_##name},

CLUXEL_CASTS(CLUXEL_CAST_BODY)
constexpr auto kCasts = std::to_array<FunctionEntry>({CLUXEL_CASTS(CLUXEL_CAST_ENTRY)});

}  // namespace

FunctionContext::FunctionContext(QueryTerms& query_terms)
    : terms(query_terms), regexes(std::make_unique<RegexCache>()), geometries(std::make_unique<GeometryCache>()) {}
FunctionContext::~FunctionContext() = default;

void FunctionContext::note(std::string_view text) {
  constexpr std::size_t kMaxNotes = 8;
  if (notes.size() < kMaxNotes) notes.emplace(text);
}

const FunctionEntry* findBuiltin(ast::Builtin builtin) {
  for (const BuiltinEntry& entry : kBuiltins) {
    if (entry.builtin == builtin) return &entry.entry;
  }
  return nullptr;
}

const FunctionEntry* findFunction(std::string_view iri) {
  for (const FunctionEntry& entry : kCasts) {
    if (entry.name == iri) return &entry;
  }
  for (const FunctionEntry& entry : kNamedFunctions) {
    if (entry.name == iri) return &entry;
  }
  return nullptr;
}

std::vector<std::string> functionIris() {
  std::vector<std::string> iris;
  for (const FunctionEntry& entry : kNamedFunctions) iris.emplace_back(entry.name);
  for (const FunctionEntry& entry : kCasts) iris.emplace_back(entry.name);
  return iris;
}

}  // namespace cluxel::sparql
