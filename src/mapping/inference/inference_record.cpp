// SPDX-License-Identifier: Apache-2.0
// One block: what it belongs to, then lists of ids.
#include "mapping/inference/inference_record.hpp"

#include <cstring>
#include <string_view>

#include "base/content_hash.hpp"
#include "mapping/map_tables.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace {

constexpr std::string_view kKey = "inferred";
/// Increase it when the program infers other facts, or stores the record in another form.
constexpr std::uint32_t kVersion = 4;

/// What the record belongs to.
struct Basis {
  std::uint32_t version = kVersion, rules = 0;
  ContentHash texts;
  std::uint64_t quads = 0, hash = 0;
};

Basis basisOf(const std::vector<NamedText>& rules, const rdf::EntrySum& sum) {
  ContentHasher hasher;
  for (const NamedText& rule : rules) hasher.addText(rule.name).addText(rule.text);
  return {kVersion, static_cast<std::uint32_t>(rules.size()), hasher.finish(), sum.count, sum.hash};
}

struct StoredLate {
  rdf::Triple fact;
  std::uint32_t stage_and_base = 0;
};

template <typename Value>
void append(std::string& bytes, const Value& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// `Values`: a vector or a string.
template <typename Values>
void appendList(std::string& bytes, const Values& values) {
  using Value = typename Values::value_type;
  append(bytes, static_cast<std::uint64_t>(values.size()));
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
}

/// Takes a list from the front of the bytes; none when they are too few.
template <typename Value>
std::optional<std::vector<Value>> takeList(std::string_view& bytes) {
  std::uint64_t count = 0;
  if (bytes.size() < sizeof count) return std::nullopt;
  std::memcpy(&count, bytes.data(), sizeof count);
  bytes.remove_prefix(sizeof count);
  if (bytes.size() / sizeof(Value) < count) return std::nullopt;
  std::vector<Value> values(count);
  if (count > 0) std::memcpy(values.data(), bytes.data(), count * sizeof(Value));
  bytes.remove_prefix(count * sizeof(Value));
  return values;
}

}  // namespace

void storeInferenceRecord(rdf::WriteTransaction& transaction, const InferenceRecord& record,
                          const std::vector<NamedText>& rules) {
  const rdf::QuadReader reader{static_cast<const rdf::ReadTransaction&>(transaction)};
  const auto history = reader.idOf(Term::iri(rdf::vocabulary::kGraphHistory));
  const rdf::EntrySum sum = rdf::sumWithout(transaction, history.value_or(rdf::kNoGraph));
  std::string bytes;
  append(bytes, basisOf(rules, sum));
  appendList(bytes, record.reason);
  appendList(bytes, record.rounds);
  for (const Outputs& outputs : record.outputs) appendList(bytes, outputs);
  std::vector<StoredLate> late;
  for (const rdf::LateFact& fact : record.late)
    late.push_back({fact.fact, fact.stage << 1U | static_cast<std::uint32_t>(fact.is_base)});
  appendList(bytes, late);
  appendList(bytes, record.excluded);
  transaction.putBlock(tables::kMeta, kKey, bytes);
}

std::optional<InferenceRecord> storedInferenceRecord(const rdf::ReadTransaction& transaction,
                                                     const std::vector<NamedText>& rules, const rdf::EntrySum& sum) {
  const auto block = transaction.block(tables::kMeta, kKey);
  const Basis basis = basisOf(rules, sum);
  if (!block || block->size() < sizeof basis || std::memcmp(block->data(), &basis, sizeof basis) != 0)
    return std::nullopt;
  std::string_view bytes = block->substr(sizeof basis);
  InferenceRecord record;
  const auto reason = takeList<char>(bytes);
  const auto rounds = takeList<std::uint32_t>(bytes);
  if (!reason || !rounds || rounds->size() != rules.size()) return std::nullopt;
  record.reason.assign(reason->begin(), reason->end());
  record.rounds = *rounds;
  for (std::size_t i = 0; i < rules.size(); ++i) {
    auto outputs = takeList<RuleOutput>(bytes);
    if (!outputs) return std::nullopt;
    record.outputs.push_back(std::move(*outputs));
  }
  const auto late = takeList<StoredLate>(bytes);
  auto excluded = takeList<rdf::Triple>(bytes);
  if (!late || !excluded) return std::nullopt;
  record.excluded = std::move(*excluded);
  for (const StoredLate& fact : *late)
    record.late.push_back({fact.fact, fact.stage_and_base >> 1U, (fact.stage_and_base & 1U) != 0});
  return record;
}

}  // namespace cluxel::mapping
