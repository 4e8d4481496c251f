// SPDX-License-Identifier: Apache-2.0
// Follows a change through the closure and through the rules, one stage after the other.
#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "mapping/inference/affected_keys.hpp"
#include "mapping/inference/infer_facts.hpp"
#include "mapping/inference/inference_graphs.hpp"
#include "mapping/inference/inference_properties.hpp"
#include "mapping/inference/inference_record.hpp"
#include "mapping/inference/read_test.hpp"
#include "mapping/inference/rule_evaluation.hpp"
#include "mapping/inference/temporary_quads.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/ontology/staged_closure.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace {

using rdf::FactState;
using rdf::kNever;
using rdf::LateFact;
using rdf::Stage;
using rdf::StagedFacts;
using rdf::Triple;

using Outputs = std::vector<RuleOutput>;

struct ChangedQuad {
  rdf::QuadIds quad;
  bool is_added = false;
};

Triple factOf(const ChangedQuad& changed) {
  return {changed.quad.s, changed.quad.p, changed.quad.o};
}

class ChangeInference {
 public:
  ChangeInference(rdf::WriteTransaction& transaction, const InferenceGraphs& graphs, InferenceRecord& record,
                  const rdf::InferenceCheck& check)
      : transaction_(transaction),
        graphs_(graphs),
        record_(record),
        check_(check),
        reader_(static_cast<const rdf::ReadTransaction&>(transaction)),
        words_(reader_),
        bounds_(reader_, limits()),
        schema_(rdf::readStoredSchema(reader_, words_, allGraphs(), bounds_)),
        facts_(reader_, words_, graphs.sources, graphs.inferred, std::move(record.late)),
        closure_(reader_, words_, schema_, facts_, bounds_) {}

  /// Each of these returns false when the change cannot be followed.
  bool followStated(const rdf::QuadDifference& change, const std::vector<RuleShape>& rules);
  bool followRule(Stage stage, const RuleShape& shape, Outputs& outputs);
  void finish();

  std::vector<WholeRule> takeWhole() { return std::move(whole_); }  ///< rules that were evaluated for the whole map
  std::vector<std::string> ignored() const { return ignoredAxioms(reader_, schema_); }

 private:
  rdf::ClosureLimits limits() const {
    rdf::ClosureLimits limits = rdf::ClosureLimits::of(reader_);
    limits.check = check_;
    return limits;
  }
  std::vector<rdf::TermId> allGraphs() const {
    std::vector<rdf::TermId> graphs = graphs_.sources;
    graphs.push_back(graphs_.inferred);
    return graphs;
  }
  void write() {
    rdf::QuadWriter writer(transaction_);
    facts_.write(writer);
  }
  std::optional<Outputs> solutions(Stage stage, const RuleShape& shape, const ReadTest& reads,
                                   const std::optional<std::vector<rdf::TermId>>& keys);
  std::vector<rdf::QuadIds> unseen(Stage stage, const ReadTest& reads) const;
  std::vector<ChangedQuad> statedOrWithdrawn(const rdf::QuadDifference& change,
                                             const InferenceProperties& properties) const;
  bool isStatedBeside(std::span<const ChangedQuad> of_fact, rdf::PrefixLookup& stored) const;
  std::vector<SeenChange> seenChanges(Stage stage, const ReadTest& reads) const;
  bool isOtherBefore(Stage stage, const Triple& fact) const;
  void setBases(Stage stage, const RuleShape& shape, std::vector<Triple> touched, const Outputs& outputs);
  bool touchesDerivations(const rdf::QuadDifference& change) const;
  bool feedsItself(Stage stage, const ReadTest& reads) const;

  rdf::WriteTransaction& transaction_;
  const InferenceGraphs& graphs_;
  InferenceRecord& record_;
  const rdf::InferenceCheck& check_;
  rdf::QuadReader reader_;
  rdf::SchemaWords words_;
  rdf::ClosureBounds bounds_;
  rdf::Schema schema_;
  StagedFacts facts_;
  std::unordered_map<rdf::TermId, std::vector<SeenChange>> plain_;  ///< changes of properties that are only read
  rdf::StagedClosure closure_;
  std::vector<WholeRule> whole_;
};

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

/// What the store holds of facts that a rule of this stage reads but may not see.
std::vector<rdf::QuadIds> ChangeInference::unseen(Stage stage, const ReadTest& reads) const {
  std::vector<rdf::QuadIds> quads;
  const auto add = [&](const Triple& fact) { quads.push_back({fact.s, fact.p, fact.o, graphs_.inferred}); };
  for (const rdf::TermId property : reads.properties()) {
    for (const LateFact& late : facts_.lateOf(property))
      if (late.stage >= stage && reads.matches(late.fact) && !facts_.changed().contains(late.fact)) add(late.fact);
    for (const Triple& fact : facts_.changedOf(property)) {
      if (!reads.matches(fact)) continue;
      const FactState& state = facts_.changed().at(fact);
      if (state.is_written && state.now >= stage && state.now != kNever) add(fact);
    }
  }
  return quads;
}

/// The facts that a rule of this stage reads and that it saw before the change and does not see now, or the other way
/// round.
std::vector<SeenChange> ChangeInference::seenChanges(Stage stage, const ReadTest& reads) const {
  std::vector<SeenChange> changes;
  for (const rdf::TermId property : reads.properties()) {
    for (const Triple& fact : facts_.changedOf(property))
      if (reads.matches(fact) && isOtherBefore(stage, fact))
        changes.push_back({fact, facts_.changed().at(fact).now != kNever});
    if (const auto plain = plain_.find(property); plain != plain_.end())
      for (const SeenChange& one : plain->second)
        if (reads.matches(one.fact)) changes.push_back(one);
  }
  return changes;
}

/// Whether the fact has become known before a stage, or has ceased to be.
bool ChangeInference::isOtherBefore(Stage stage, const Triple& fact) const {
  const auto changed = facts_.changed().find(fact);
  return changed != facts_.changed().end() && (changed->second.before < stage) != (changed->second.now < stage);
}

/// The solutions of the rule for some keys, or all, from the facts of earlier stages.
std::optional<Outputs> ChangeInference::solutions(Stage stage, const RuleShape& shape, const ReadTest& reads,
                                                  const std::optional<std::vector<rdf::TermId>>& keys) {
  std::optional<ValuesOf> values;
  if (keys) {
    if (keys->empty()) return Outputs{};
    values = ValuesOf{shape.key, {}};
    for (const rdf::TermId key : *keys) values->terms.push_back(reader_.termOf(key));
  }
  std::vector<rdf::QuadIds> hidden = unseen(stage, reads);
  if (shape.is_plain && !hidden.empty()) {
    const IsSeen is_seen = [&](const Triple& fact) { return facts_.stageOf(fact) < stage; };
    return evaluateRule(transaction_, shape, check_, values, is_seen);
  }
  TemporaryQuads without(transaction_, {}, std::move(hidden));
  Outputs outputs = evaluateRule(transaction_, shape, check_, values);
  without.end();
  return outputs;
}

bool ChangeInference::followRule(Stage stage, const RuleShape& shape, Outputs& outputs) {
  const ReadTest reads(reader_, shape);
  const std::vector<SeenChange> relevant = seenChanges(stage, reads);
  std::vector<Triple> touched;
  if (!relevant.empty()) {
    write();
    std::optional<std::vector<rdf::TermId>> keys;
    if (shape.following == RuleShape::Following::ByKey) {
      AffectedKeys affected(transaction_, facts_, graphs_.inferred, shape, reads, check_);
      keys = affected.of(relevant);
      constexpr std::size_t kFewKeys = 1000;  // below, evaluating by key is never worse by much
      if (keys && keys->size() > kFewKeys && keys->size() > outputs.size() / 2) keys.reset();
    } else {
      whole_.push_back({ruleFileName(shape.rule), shape.reason});
    }
    const std::optional<Outputs> now = solutions(stage, shape, reads, keys);
    touched = replaceOutputs(outputs, keys, *now);
  }
  for (const RuleOutput& output : outputs)
    if (isOtherBefore(stage, output.fact)) touched.push_back(output.fact);
  if (touched.empty()) return true;
  setBases(stage, shape, std::move(touched), outputs);
  return !facts_.touchesSchema() && !feedsItself(stage, reads);
}

/// Decides for each fact that the rule derives, or has derived, whether it holds by the rule.
void ChangeInference::setBases(Stage stage, const RuleShape& shape, std::vector<Triple> touched,
                               const Outputs& outputs) {
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  std::unordered_set<Triple, rdf::TripleHash> derived;
  for (const RuleOutput& output : outputs)
    if (std::binary_search(touched.begin(), touched.end(), output.fact)) derived.insert(output.fact);
  std::vector<rdf::BaseChange> bases;
  rdf::QuadWriter writer(transaction_);
  const auto set = [&](const Triple& fact, bool is_base) {
    const Stage base = facts_.stateOf(fact).base;
    if (is_base && base > stage) bases.push_back({fact, stage});
    if (!is_base && base == stage) bases.push_back({fact, kNever});
  };
  for (const Triple& fact : touched) {
    const bool is_base = derived.contains(fact) && facts_.stageOf(fact) >= stage;
    set(fact, is_base);
    for (const Triple& part : derivationOf(reader_, writer, fact, shape.rule)) set(part, is_base);
  }
  writer.flush();
  closure_.update(bases);
}

/// Whether the rule reads what has come to be at its own stage: then it would have to be run again.
bool ChangeInference::feedsItself(Stage stage, const ReadTest& reads) const {
  const auto feeds = [&](const Triple& fact) { return reads.matches(fact) && facts_.changed().at(fact).now == stage; };
  return std::any_of(reads.properties().begin(), reads.properties().end(), [&](rdf::TermId property) {
    const std::vector<Triple>& changed = facts_.changedOf(property);
    return std::any_of(changed.begin(), changed.end(), feeds);
  });
}

void ChangeInference::finish() {
  write();
  record_.late = facts_.lateNow();
}

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
    if (!inference.followRule(static_cast<Stage>(i + 1), shapes[i], record->outputs[i])) return std::nullopt;
  inference.finish();
  noteIgnoredAxioms(inference.ignored(), sink);
  storeInferenceRecord(transaction, *record, rules);
  restartJournal(transaction);
  return inference.takeWhole();
}

}  // namespace cluxel::mapping
