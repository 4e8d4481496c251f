// SPDX-License-Identifier: Apache-2.0
// Looks up terms and values of a query and assigns ids to computed terms.
#include "sparql/exec/query_terms.hpp"

#include "base/ascii.hpp"
#include "cluxel/error.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/values/datatype.hpp"

namespace cluxel::sparql {
namespace {

const TextPayload* textPayload(const Value& value) {
  return value.payload ? std::get_if<TextPayload>(value.payload.get()) : nullptr;
}

/// Of a node of a hash table of the standard library.
constexpr std::size_t kBytesOfNode = 64;

/// Of an entry of IdTable, which is at least a quarter full when it is large.
constexpr std::size_t kBytesOfKnown = 64;

std::size_t hashOfTerm(const rdf::TermView& term) {
  const std::hash<std::string_view> hash;
  return hash(term.text) * 31 + hash(term.datatype) * 17 + hash(term.language) + static_cast<std::size_t>(term.kind);
}

/// A text that does not fit into its string.
std::size_t bytesOutside(const std::string& text) {
  return text.capacity() < 16 ? 0 : text.capacity();
}

/// The type of a term whose value is its text: it needs no copy of it.
std::optional<Value::Type> typeOfText(const rdf::TermView& term) {
  if (term.kind == TermKind::Iri) return Value::Type::Iri;
  if (term.kind == TermKind::BlankNode) return Value::Type::Blank;
  if (!term.language.empty()) return Value::Type::LangString;
  const DatatypeInfo* info = findDatatype(term.datatype);
  return info != nullptr && info->type == Value::Type::String ? std::optional(info->type) : std::nullopt;
}

Value withId(Value value, ValueId id) {
  value.id = id;
  return value;
}

}  // namespace

/// Ids may come from damaged indexes of the store.
const QueryTerms::Computed& QueryTerms::computedAt(ValueId id) const {
  const std::size_t place = id - kFirstComputed;
  if (place < computed_.size()) return computed_[place];
  throw Error(ErrorKind::StoreUnavailable, "the map is damaged: an index names term " + std::to_string(id) +
                                               ", which does not exist; run `cluxel doctor` for the location");
}

const std::string* QueryTerms::heldOnce(std::string& name) {
  static const std::string none;
  if (name.empty()) return &none;
  if (last_name_ != nullptr && *last_name_ == name) return last_name_;
  const auto [held, is_new] = names_.insert(std::move(name));
  if (is_new) computed_bytes_ += kBytesOfNode + sizeof(std::string) + bytesOutside(*held);
  return last_name_ = &*held;
}

bool QueryTerms::isSame(ValueId id, const Term& term) const {
  const rdf::TermView own = view(id);
  return own.kind == term.kind && own.text == term.text && own.datatype == term.datatype &&
         own.language == term.language;
}

Value QueryTerms::valueOf(ValueId id) const {
  if (id == kUnbound) return {};
  return valueOfStored(id);
}

Value QueryTerms::valueOfStored(ValueId id) const {
  Value value;
  value.id = id;
  if (id < kFirstComputed) {
    const rdf::DecodedValue& decoded = reader_.valueOf(id);
    using Type = rdf::DecodedValue::Type;
    if (decoded.kind == TermKind::Iri) return value.type = Value::Type::Iri, value;
    if (decoded.kind == TermKind::BlankNode) return value.type = Value::Type::Blank, value;
    value.integer = decoded.integer;
    value.number = decoded.number;
    switch (decoded.type) {
      case Type::Integer:
        value.type = Value::Type::Integer;
        value.number = static_cast<double>(decoded.integer);
        return value;
      case Type::Float:
        return value.type = Value::Type::Float, value;
      case Type::Double:
        return value.type = Value::Type::Double, value;
      case Type::Decimal:
        value.scale = decoded.scale;
        return value.type = Value::Type::Decimal, value;
      case Type::Boolean:
        return value.type = Value::Type::Boolean, value;
      case Type::String:
        return value.type = Value::Type::String, value;
      case Type::LangString:
        return value.type = Value::Type::LangString, value;
      default:
        break;
    }
  }
  const auto known = decoded_.find(id);
  if (known != decoded_.end()) return known->second;
  const rdf::TermView seen = view(id);
  if (const auto type = typeOfText(seen)) return value.type = *type, value;
  value = withId(valueOfTerm(seen.kind, seen.text, seen.datatype, seen.language), id);
  decoded_.emplace(id, value);
  computed_bytes_ += sizeof(Value) + kBytesOfNode;
  return value;
}

rdf::TermView QueryTerms::view(ResultId id) const {
  return id >= kFirstComputed ? viewOf(computedAt(id)) : reader_.viewOf(id);
}

Term QueryTerms::termOf(ValueId id) const {
  return id >= kFirstComputed ? viewOf(computedAt(id)).toTerm() : reader_.termOf(id);
}

ValueId QueryTerms::intern(Term term) {
  const std::size_t hash = hashOfTerm(rdf::TermView::of(term));
  const ValueId known = known_.find(hash, [&](ValueId id) { return isSame(id, term); });
  if (known != kUnbound) return known;
  ValueId id = kUnbound;
  if (const auto stored = reader_.idOf(term)) {
    id = *stored;
  } else {
    if (computed_.size() >= kFirstComputed - 1)
      throw Error(ErrorKind::BudgetExceeded, "query: too many computed terms");
    id = kFirstComputed + static_cast<ValueId>(computed_.size());
    const std::string *datatype = heldOnce(term.datatype), *language = heldOnce(term.language);
    computed_.push_back({term.kind, std::move(term.text), datatype, language});
    computed_bytes_ += sizeof(Computed) + bytesOutside(computed_.back().text);
  }
  if (id != kUnbound) known_.insert(hash, id);
  computed_bytes_ += kBytesOfKnown;
  return id;
}

ValueId QueryTerms::intern(const Value& value) {
  if (value.id != kUnbound || value.isError()) return value.id;
  return intern(termOfComputed(value));
}

std::string_view QueryTerms::textOf(const Value& value, std::string& scratch) const {
  if (const TextPayload* text = textPayload(value)) return text->text;
  if (value.id != kUnbound) return view(value.id).text;
  scratch = termOfComputed(value).text;
  return scratch;
}

std::string QueryTerms::textOf(const Value& value) const {
  if (const TextPayload* text = textPayload(value)) return text->text;
  if (value.id != kUnbound) return std::string(view(value.id).text);
  return termOfComputed(value).text;
}

std::string QueryTerms::languageOf(const Value& value) const {
  if (value.type != Value::Type::LangString) return {};
  if (const TextPayload* text = textPayload(value)) return text->language;
  return std::string(view(value.id).language);
}

std::string QueryTerms::datatypeOf(const Value& value) const {
  if (value.type == Value::Type::LangString) return rdf::vocabulary::rdf("langString");
  if (value.id != kUnbound && value.type != Value::Type::String) return std::string(view(value.id).datatype);
  return std::string(datatypeIri(value));
}

Decimal QueryTerms::exactOf(const Value& value) const {
  if (value.payload || value.scale != Value::kNoScale || value.id == kUnbound) return value.exact();
  return Decimal::parse(trimmed(view(value.id).text)).value_or(Decimal());
}

CalendarTime QueryTerms::calendarOf(const Value& value) const {
  return std::get<CalendarTime>(*value.payload);
}
Duration QueryTerms::durationOf(const Value& value) const {
  return std::get<Duration>(*value.payload);
}

Term QueryTerms::termOf(const Value& value) const {
  return value.id != kUnbound ? termOf(value.id) : termOfComputed(value);
}

void QueryTerms::rewind(std::size_t mark) {
  if (computed_.size() == mark) return;
  const ValueId first = kFirstComputed + static_cast<ValueId>(mark);
  while (computed_.size() > mark) {
    const ValueId last = kFirstComputed + static_cast<ValueId>(computed_.size() - 1);
    known_.erase(hashOfTerm(viewOf(computed_.back())), last);
    computed_.pop_back();
  }
  computed_bytes_ = 0;
  std::erase_if(decoded_, [first](const auto& entry) { return entry.first >= first; });
}

}  // namespace cluxel::sparql
