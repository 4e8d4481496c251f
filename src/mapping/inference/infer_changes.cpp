// SPDX-License-Identifier: Apache-2.0
// Follows a change through the closure and through the rules, one stage after the other.
#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <span>
#include <utility>

#include "mapping/inference/change_inference.hpp"
#include "mapping/inference/infer_facts.hpp"
#include "mapping/statements/excluded_types.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

using rdf::kNever;
using rdf::Stage;
using rdf::Triple;

namespace {

Triple factOf(const ChangedQuad& changed) {
  return {changed.quad.s, changed.quad.p, changed.quad.o};
}

}  // namespace

ChangeInference::ChangeInference(rdf::WriteTransaction& transaction, const InferenceGraphs& graphs,
                                 InferenceRecord& record, const rdf::InferenceCheck& check)
    : transaction_(transaction),
      graphs_(graphs),
      record_(record),
      check_(check),
      reader_(static_cast<const rdf::ReadTransaction&>(transaction)),
      words_(reader_),
      bounds_(reader_, limits()),
      schema_(rdf::readStoredSchema(reader_, words_, allGraphs(), bounds_)),
      facts_(reader_, words_, graphs.sources, graphs.inferred, std::move(record.late)),
      closure_(reader_, words_, schema_, facts_, bounds_) {
  std::vector<Triple> excluded = excludedTypes(reader_);
  std::set_symmetric_difference(excluded.begin(), excluded.end(), record.excluded.begin(), record.excluded.end(),
                                std::back_inserter(reconsidered_));
  record.excluded = std::move(excluded);
}

rdf::ClosureLimits ChangeInference::limits() const {
  rdf::ClosureLimits limits = rdf::ClosureLimits::of(reader_);
  limits.check = check_;
  return limits;
}

std::vector<rdf::TermId> ChangeInference::allGraphs() const {
  std::vector<rdf::TermId> graphs = graphs_.sources;
  graphs.push_back(graphs_.inferred);
  return graphs;
}

std::vector<std::string> ChangeInference::ignored() const {
  return ignoredAxioms(reader_, schema_);
}

void ChangeInference::write() {
  rdf::QuadWriter writer(transaction_);
  facts_.write(writer);
}

bool ChangeInference::followStated(const rdf::QuadDifference& change, const std::vector<RuleShape>& rules) {
  const InferenceProperties properties(reader_, words_, schema_, rules);
  const std::vector<ChangedQuad> quads = statedOrWithdrawn(change, properties);
  std::vector<rdf::BaseChange> bases;
  rdf::PrefixLookup stored = reader_.lookup(rdf::QuadOrder::Spog);  // facts ascend
  for (std::span<const ChangedQuad> rest(quads); !rest.empty();) {
    const Triple fact = factOf(rest.front());
    const auto end = std::find_if(rest.begin(), rest.end(), [&](const auto& quad) { return factOf(quad) != fact; });
    const std::span<const ChangedQuad> of_fact(rest.begin(), end);
    rest = {end, rest.end()};
    const auto is_added = [](const ChangedQuad& quad) { return quad.is_added; };
    const bool is_stated = std::any_of(of_fact.begin(), of_fact.end(), is_added);
    const bool was_stated = !std::all_of(of_fact.begin(), of_fact.end(), is_added);
    if (is_stated == was_stated || isStatedBeside(of_fact, stored)) continue;
    if (properties.useOf(fact.p) == PropertyUse::Read) {
      plain_[fact.p].push_back({fact, is_stated});
    } else {
      facts_.restate(fact, was_stated);
      bases.push_back({fact, is_stated ? 0 : kNever});
    }
  }
  if (facts_.touchesSchema()) return false;
  closure_.update(bases);
  return !facts_.touchesSchema() && !touchesDerivations(change);
}

/// Whether another graph states this fact, both before the change and now.
bool ChangeInference::isStatedBeside(std::span<const ChangedQuad> of_fact, rdf::PrefixLookup& stored) const {
  const Triple fact = factOf(of_fact.front());
  const auto is_beside = [&](const rdf::QuadKey& entry) {
    const rdf::TermId graph = rdf::toQuad(entry, rdf::QuadOrder::Spog).g;
    return graphs_.isSource(graph) &&
           std::none_of(of_fact.begin(), of_fact.end(), [&](const auto& changed) { return changed.quad.g == graph; });
  };
  for (auto entries = stored.find(std::array{fact.s, fact.p, fact.o}); !entries.empty(); entries = stored.more())
    if (std::any_of(entries.begin(), entries.end(), is_beside)) return true;
  return false;
}

/// The quads that were added or removed in graphs of stated facts, and which inference uses; sorted.
std::vector<ChangedQuad> ChangeInference::statedOrWithdrawn(const rdf::QuadDifference& change,
                                                            const InferenceProperties& properties) const {
  std::vector<ChangedQuad> quads;
  const auto add = [&](const rdf::QuadIds& quad, bool is_added) {
    if (graphs_.isSource(quad.g) && properties.useOf(quad.p) != PropertyUse::None) quads.push_back({quad, is_added});
  };
  for (const rdf::QuadIds& quad : change.added) add(quad, true);
  const auto removed = static_cast<std::ptrdiff_t>(quads.size());
  for (const rdf::QuadIds& quad : change.removed) add(quad, false);
  std::inplace_merge(quads.begin(), quads.begin() + removed, quads.end(),
                     [](const ChangedQuad& a, const ChangedQuad& b) { return a.quad < b.quad; });
  return quads;
}

/// Whether a fact that describes a derivation was stated or withdrawn. Rules do not check these facts again.
bool ChangeInference::touchesDerivations(const rdf::QuadDifference& change) const {
  std::vector<std::optional<rdf::TermId>> parts;
  for (const std::string& property : propertiesOfDerivations()) parts.push_back(reader_.idOf(Term::iri(property)));
  const auto type = reader_.idOf(Term::iri(rdf::vocabulary::clx("Derivation")));
  const auto is_part = [&](const auto& fact) {
    return (fact.p == words_.type ? fact.o == type : std::find(parts.begin(), parts.end(), fact.p) != parts.end()) &&
           isDerivation(reader_.viewOf(fact.s));
  };
  return std::any_of(change.added.begin(), change.added.end(), is_part) ||
         std::any_of(change.removed.begin(), change.removed.end(), is_part) ||
         std::any_of(facts_.changed().begin(), facts_.changed().end(), [&](const auto& entry) {
           return entry.second.before != entry.second.now && is_part(entry.first);
         });
}

void ChangeInference::finish() {
  write();
  record_.late = facts_.lateNow();
}

namespace {

/// Following a quad costs as much as inferring anew from some seven.
bool isLarge(const rdf::WriteTransaction& transaction, const rdf::QuadDifference& change) {
  constexpr std::uint64_t kFewQuads = 1000, kShare = 7;
  const rdf::QuadReader reader(static_cast<const rdf::ReadTransaction&>(transaction));
  return change.added.size() + change.removed.size() > kFewQuads + reader.size() / kShare;
}

}  // namespace

std::optional<std::vector<WholeRule>> inferChanges(rdf::WriteTransaction& transaction,
                                                   const std::vector<NamedText>& rules, ProgressSink& sink,
                                                   const rdf::InferenceCheck& check) {
  const auto change = changesOf(transaction);
  if (!change || isLarge(transaction, *change)) return std::nullopt;
  const InferenceGraphs graphs{rdf::QuadReader(static_cast<const rdf::ReadTransaction&>(transaction))};
  const rdf::EntrySum sum = sumBefore(sumWithout(transaction, graphs.history), *change, graphs.history);
  auto record = storedInferenceRecord(transaction, rules, sum);
  if (!record) return std::nullopt;
  if (!record->reason.empty()) {
    sink.note("everything is inferred anew at each change: " + record->reason);
    return std::nullopt;
  }
  const auto is_inferred = [&](const rdf::QuadIds& quad) { return quad.g == graphs.inferred; };
  if (!graphs.are_all || std::any_of(change->added.begin(), change->added.end(), is_inferred) ||
      std::any_of(change->removed.begin(), change->removed.end(), is_inferred))
    return std::nullopt;
  ChangeInference inference(transaction, graphs, *record, check);
  std::vector<RuleShape> shapes;
  for (const NamedText& rule : rules) shapes.push_back(shapeOf(rule));
  if (!inference.followStated(*change, shapes)) return std::nullopt;
  for (std::size_t i = 0; i < shapes.size(); ++i)
    if (!inference.followRule(static_cast<Stage>(i + 1), shapes[i], record->outputs[i], record->rounds[i]))
      return std::nullopt;
  inference.finish();
  noteIgnoredAxioms(inference.ignored(), sink);
  storeInferenceRecord(transaction, *record, rules);
  restartJournal(transaction);
  return inference.takeWhole();
}

}  // namespace cluxel::mapping
