// SPDX-License-Identifier: Apache-2.0
// Encodes and decodes stored terms.
#include "rdf/terms/term_record.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstring>
#include <stdexcept>

#include "cluxel/error.hpp"
#include "rdf/terms/literal_value.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

using Type = DecodedValue::Type;

// The head byte: two bits kind, four bits type of value, then these.
constexpr std::uint8_t kHasDatatype = 0x40, kHasLanguage = 0x80;

template <typename T>
void append(std::string& bytes, T value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof raw);
}

bool storesInteger(Type type) {
  return type == Type::Integer || type == Type::Boolean || type == Type::DateTime || type == Type::Date;
}

bool storesNumber(Type type) {
  return type == Type::Decimal || type == Type::Float || type == Type::Double;
}

[[noreturn]] void failOnTerm() {
  throw Error(ErrorKind::StoreUnavailable,
              "the map is damaged: a term is malformed; run `cluxel doctor` for the location");
}

template <typename T>
T take(std::string_view& bytes) {
  if (bytes.size() < sizeof(T)) failOnTerm();
  T value;
  std::memcpy(&value, bytes.data(), sizeof value);
  bytes.remove_prefix(sizeof value);
  return value;
}

void takeValue(std::string_view& bytes, DecodedValue& value) {
  if (storesInteger(value.type)) {
    value.integer = take<std::int64_t>(bytes);
    value.number = static_cast<double>(value.integer);
    if (value.type == Type::DateTime || value.type == Type::Date) value.number /= 1e6;
  } else if (storesNumber(value.type)) {
    value.number = take<double>(bytes);
  }
}

}  // namespace

bool needsDatatypeId(const Term& term) {
  return term.kind == TermKind::Literal && term.language.empty() && term.datatype != vocabulary::xsd("string") &&
         term.datatype != vocabulary::rdf("langString");
}

void encodeTerm(const Term& term, TermId datatype, std::string& bytes) {
  bytes.clear();
  DecodedValue value;
  if (term.kind == TermKind::Literal) value = decodeLiteral(term.text, term.datatype);
  if (!term.language.empty()) value.type = Type::LangString;
  std::uint8_t head = static_cast<std::uint8_t>(term.kind);
  head |= static_cast<std::uint8_t>(static_cast<unsigned>(value.type) << 2U);
  if (datatype != kNoTerm) head |= kHasDatatype;
  if (!term.language.empty()) head |= kHasLanguage;
  append(bytes, head);
  if (datatype != kNoTerm) append(bytes, datatype);
  if (!term.language.empty()) {
    if (term.language.size() > 0xFFFF) throw std::length_error("a language tag is longer than 65535 bytes");
    append(bytes, static_cast<std::uint16_t>(term.language.size()));
    bytes += term.language;
  }
  if (storesInteger(value.type)) append(bytes, value.integer);
  if (storesNumber(value.type)) append(bytes, value.number);
  bytes += term.text;
}

TermRecord decodeTerm(std::string_view bytes) {
  TermRecord record;
  const auto head = take<std::uint8_t>(bytes);
  const unsigned kind = head & 3U;
  const unsigned type = (head >> 2U) & 15U;
  if (kind > static_cast<unsigned>(TermKind::Literal) || type > static_cast<unsigned>(Type::Date)) failOnTerm();
  record.kind = static_cast<TermKind>(kind);
  if ((head & kHasDatatype) != 0) record.datatype = take<TermId>(bytes);
  if ((head & kHasLanguage) != 0) {
    const auto size = take<std::uint16_t>(bytes);
    if (size > bytes.size()) failOnTerm();
    record.language = bytes.substr(0, size);
    bytes.remove_prefix(size);
  }
  record.value.type = static_cast<Type>(type);
  record.value.kind = record.kind;
  record.value.datatype = record.datatype;
  takeValue(bytes, record.value);
  record.text = bytes;
  return record;
}

TermHash hashOfRecord(std::string_view bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return {hash.high64, static_cast<std::uint32_t>(hash.low64)};
}

}  // namespace cluxel::rdf
