// SPDX-License-Identifier: Apache-2.0
// Reads quads and terms of one commit.
#include "rdf/store/quad_store.hpp"

#include <algorithm>
#include <array>

#include "rdf/store/geometry_index.hpp"
#include "rdf/store/literal_entries.hpp"
#include "rdf/store/number_entries.hpp"
#include "rdf/store/quad_cursor.hpp"
#include "rdf/store/quad_reader_impl.hpp"
#include "rdf/terms/literal_value.hpp"
#include "rdf/terms/term_record.hpp"
#include "rdf/terms/value_cache.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

/// The bound ids in s, p, o, g order; 0 in s, p or o is a wildcard.
std::array<std::optional<TermId>, 4> boundIds(const QuadPattern& pattern) {
  std::array<std::optional<TermId>, 4> ids = {pattern.s, pattern.p, pattern.o, pattern.g};
  for (std::size_t i = 0; i < 3; ++i)
    if (ids[i] == kNoTerm) ids[i].reset();
  return ids;
}

const std::string kString = vocabulary::xsd("string");
const std::string kLangString = vocabulary::rdf("langString");

}  // namespace

IndexPattern layOut(const QuadPattern& pattern, QuadOrder order) {
  const auto bound = boundIds(pattern);
  IndexPattern laid_out;
  std::array<TermId, 4> prefix{};
  bool in_prefix = true;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::optional<TermId>& id = bound[placesOf(order)[i]];
    in_prefix = in_prefix && id.has_value();
    if (in_prefix) prefix[laid_out.prefix_length++] = *id;
    if (in_prefix || !id) continue;
    const auto shift = static_cast<unsigned>(32 * (3 - i));
    laid_out.mask |= Key128{0xFFFFFFFFU} << shift;
    laid_out.value |= Key128{*id} << shift;
    laid_out.filtered = true;
  }
  laid_out.range = rangeOf(std::span(prefix).first(laid_out.prefix_length));
  return laid_out;
}

std::span<const QuadKey> keysWithin(std::span<const QuadKey> keys, const KeyRange& range) {
  const auto first =
      std::partition_point(keys.begin(), keys.end(), [&](const QuadKey& key) { return toNumber(key) < range.first; });
  const auto last =
      std::partition_point(first, keys.end(), [&](const QuadKey& key) { return toNumber(key) <= range.last; });
  return {first, last};
}

QuadReader::Impl::Impl(ReadTransaction from) : transaction(std::move(from)) {
  committed_terms = state().writing ? state().committed_terms : snapshot().termCount();
}

std::string_view QuadReader::Impl::datatypeText(TermId id) {
  if (id == last_datatype && !state().writing) return last_datatype_text;
  last_datatype = id;
  last_datatype_text = decodeTerm(record(id)).text;
  return last_datatype_text;
}

QuadReader::QuadReader(ReadTransaction transaction) : impl_(std::make_unique<Impl>(std::move(transaction))) {}
QuadReader::~QuadReader() = default;
QuadReader::QuadReader(QuadReader&&) noexcept = default;
QuadReader& QuadReader::operator=(QuadReader&&) noexcept = default;

std::optional<TermId> QuadReader::idOf(const Term& term) const {
  if (term.kind == TermKind::Iri && term.text.empty()) return kNoTerm;
  TermId datatype = kNoTerm;
  if (needsDatatypeId(term)) {
    const std::optional<TermId> found = idOf(Term::iri(term.datatype));
    if (!found) return std::nullopt;
    datatype = *found;
  }
  std::string record;
  encodeTerm(term, datatype, record);
  return impl_->snapshot().idOf(hashOfRecord(record), record, impl_->state());
}

TermView QuadReader::viewOf(TermId id) const {
  if (id == kNoTerm) return {};
  const TermRecord record = decodeTerm(impl_->record(id));
  TermView view{record.kind, record.text, {}, record.language};
  if (record.kind != TermKind::Literal) return view;
  if (!record.language.empty() || record.value.type == DecodedValue::Type::LangString)
    view.datatype = kLangString;
  else if (record.datatype == kNoTerm)
    view.datatype = kString;
  else
    view.datatype = impl_->datatypeText(record.datatype);
  return view;
}

Term QuadReader::termOf(TermId id) const {
  const TermView view = viewOf(id);
  return {view.kind, std::string(view.text), std::string(view.datatype), std::string(view.language)};
}

bool QuadReader::isLiteral(TermId id) const {
  return NumberEntries(impl_->transaction).kindOf(id) != ObjectKind::Link;
}

const DecodedValue& QuadReader::valueOf(TermId id) const {
  static const DecodedValue none;
  if (id == kNoTerm) return none;
  const auto decode = [this](TermId term) {
    TermRecord record = decodeTerm(impl_->record(term));
    if (record.value.type == DecodedValue::Type::Decimal) addExactDigits(record.text, record.value);
    return record.value;
  };
  if (id <= impl_->committed_terms) return impl_->state().environment->values().get(id, decode);
  const auto found = impl_->own_values.find(id);
  return found != impl_->own_values.end() ? found->second : impl_->own_values.emplace(id, decode(id)).first->second;
}

void QuadReader::expectValues(std::span<const TermId> ids) const {
  const ValueCache& cache = impl_->state().environment->values();
  for (const TermId id : ids) cache.expect(id);
}

QuadOrder QuadReader::bestOrder(const QuadPattern& pattern) {
  constexpr auto kComplete = std::span(kQuadOrders).first<4>();  // or readers collect what lacks
  return *std::max_element(kComplete.begin(), kComplete.end(), [&](QuadOrder a, QuadOrder b) {
    return layOut(pattern, a).prefix_length < layOut(pattern, b).prefix_length;
  });
}

QuadOrder QuadReader::scanOrder(const QuadPattern& pattern) const {
  const QuadOrder best = bestOrder(pattern);
  const bool may_be_numbers = best == QuadOrder::Posg && pattern.o.value_or(kNoTerm) == kNoTerm;
  return may_be_numbers && hasOnlyNumbers(*pattern.p) ? QuadOrder::Psog : best;
}

bool QuadReader::hasOnlyNumbers(TermId predicate) const {
  const NumberEntries numbers(impl_->transaction);
  return numbers.areApart() && numbers.hasOnly(predicate);
}

/// The keys of an index that lacks some of them, or else none.
std::shared_ptr<const std::vector<QuadKey>> QuadReader::Impl::collected(const QuadPattern& pattern,
                                                                        QuadOrder order) const {
  const auto shared = [](std::vector<QuadKey> keys) {
    return std::make_shared<const std::vector<QuadKey>>(std::move(keys));
  };
  const NumberEntries numbers(transaction);
  const TermId predicate = pattern.p.value_or(kNoTerm), object = pattern.o.value_or(kNoTerm);
  if (order == QuadOrder::Ospg) {
    const LiteralEntries literals(transaction);
    if (!literals.mayMatch(pattern.o)) return nullptr;
    const bool is_apart = numbers.areApart() && pattern.s.value_or(kNoTerm) == kNoTerm && numbers.isNumber(object);
    return shared(is_apart ? numbers.matching(pattern, order) : literals.of(pattern));
  }
  if (order != QuadOrder::Posg && order != QuadOrder::Psog) return nullptr;
  if (order == QuadOrder::Psog) {
    const bool is_whole = numbers.areApart() && predicate != kNoTerm && numbers.hasOnly(predicate);
    return is_whole ? nullptr : shared(numbers.matching(pattern, order));
  }
  if (!numbers.areApart()) return nullptr;
  if (predicate == kNoTerm) return shared(numbers.matching(pattern, order));
  if (!numbers.has(predicate)) return nullptr;
  if (object == kNoTerm) return numbers.of(predicate);
  return numbers.isNumber(object) ? shared(numbers.matching(pattern, order)) : nullptr;
}

QuadCursor QuadReader::scan(const QuadPattern& pattern, QuadOrder order) const {
  const IndexPattern laid_out = layOut(pattern, order);
  if (auto keys = impl_->collected(pattern, order))
    return QuadCursor(std::make_unique<QuadCursor::Impl>(std::move(keys), laid_out, order));
  return QuadCursor(std::make_unique<QuadCursor::Impl>(impl_->directory(order), laid_out, order));
}

QuadCursor QuadReader::scan(const QuadPattern& pattern) const {
  return scan(pattern, scanOrder(pattern));
}

bool QuadReader::contains(const QuadIds& quad) const {
  const PageDirectory& directory = impl_->directory(QuadOrder::Spog);
  const Key128 key = toNumber(quad, QuadOrder::Spog);
  const PageDirectory::Position position = directory.lowerBound(key);
  return position.page < directory.pageCount() && toNumber(directory.page(position.page)[position.index]) == key;
}

std::uint64_t QuadReader::size() const {
  return impl_->snapshot().size();
}

std::uint64_t QuadReader::termCount() const {
  return impl_->snapshot().termCount();
}

std::shared_ptr<const void> QuadReader::kept(const std::string& name) const {
  return impl_->snapshot().kept(name);
}

void QuadReader::keep(const std::string& name, std::shared_ptr<const void> made) const {
  impl_->snapshot().keep(name, std::move(made));
}

std::shared_ptr<const GeometryIndex> QuadReader::geometries() const {
  constexpr const char* kName = "geometries";
  auto index = std::static_pointer_cast<const GeometryIndex>(kept(kName));
  if (index) return index;
  index = std::make_shared<const GeometryIndex>(*this, impl_->transaction);
  keep(kName, index);
  return index;
}

}  // namespace cluxel::rdf
