// SPDX-License-Identifier: Apache-2.0
// Follows a change through the closure and through the rules, one stage after the other.
#include <algorithm>
#include <optional>
#include <set>
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

bool isDerivation(std::string_view iri) {
  static const std::string some = rdf::iriOfDerivation({});
  return iri.starts_with(std::string_view(some).substr(0, some.rfind('/') + 1));
}

class ChangeInference {
 public:
  ChangeInference(rdf::WriteTransaction& transaction, const InferenceGraphs& graphs, InferenceRecord& record,
                  ProgressSink& sink, const rdf::InferenceCheck& check)
      : transaction_(transaction),
        graphs_(graphs),
        record_(record),
        sink_(sink),
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
  std::vector<Triple> statedOrWithdrawn(const rdf::QuadDifference& change) const;
  bool isStated(const Triple& fact) const;
  bool wasStated(const Triple& fact, const rdf::QuadDifference& change) const;
  std::vector<SeenChange> seenChanges(Stage stage, const ReadTest& reads) const;
  std::vector<Triple> changedTemplateFacts(Stage stage, const RuleShape& shape) const;
  void setBases(Stage stage, const RuleShape& shape, std::vector<Triple> touched, const Outputs& outputs);
  bool touchesDerivations(const rdf::QuadDifference& change) const;
  bool feedsItself(Stage stage, const ReadTest& reads) const;

  rdf::WriteTransaction& transaction_;
  const InferenceGraphs& graphs_;
  InferenceRecord& record_;
  ProgressSink& sink_;
  const rdf::InferenceCheck& check_;
  rdf::QuadReader reader_;
  rdf::SchemaWords words_;
  rdf::ClosureBounds bounds_;
  rdf::Schema schema_;
  StagedFacts facts_;
  std::unordered_map<rdf::TermId, std::vector<SeenChange>> plain_;  ///< changes of properties that are only read
  rdf::StagedClosure closure_;
};

bool ChangeInference::isStated(const Triple& fact) const {
  return std::any_of(graphs_.sources.begin(), graphs_.sources.end(), [&](rdf::TermId graph) {
    return reader_.contains(rdf::QuadIds{fact.s, fact.p, fact.o, graph});
  });
}

/// Whether some graph stated the fact before the change.
bool ChangeInference::wasStated(const Triple& fact, const rdf::QuadDifference& change) const {
  return std::any_of(graphs_.sources.begin(), graphs_.sources.end(), [&](rdf::TermId graph) {
    const rdf::QuadIds quad{fact.s, fact.p, fact.o, graph};
    const bool is_there = reader_.contains(quad);
    const auto& other = is_there ? change.added : change.removed;
    return is_there != std::binary_search(other.begin(), other.end(), quad);
  });
}

bool ChangeInference::followStated(const rdf::QuadDifference& change, const std::vector<RuleShape>& rules) {
  const InferenceProperties properties(reader_, words_, schema_, rules);
  std::vector<rdf::BaseChange> bases;
  for (const Triple& fact : statedOrWithdrawn(change)) {
    const PropertyUse use = properties.useOf(fact.p);
    if (use == PropertyUse::None) continue;
    const bool is_stated = isStated(fact);
    if (wasStated(fact, change) == is_stated) continue;
    if (use == PropertyUse::Read) {
      plain_[fact.p].push_back({fact, is_stated});
    } else {
      facts_.restate(fact, !is_stated);
      bases.push_back({fact, is_stated ? 0 : kNever});
    }
  }
  if (facts_.touchesSchema()) return false;
  closure_.update(bases);
  return !facts_.touchesSchema() && !touchesDerivations(change);
}

/// The facts of the quads that were added or removed in graphs of stated facts; sorted.
std::vector<Triple> ChangeInference::statedOrWithdrawn(const rdf::QuadDifference& change) const {
  std::vector<Triple> facts;
  for (const std::vector<rdf::QuadIds>* quads : {&change.added, &change.removed})
    for (const rdf::QuadIds& quad : *quads)
      if (graphs_.isSource(quad.g)) facts.push_back({quad.s, quad.p, quad.o});
  std::sort(facts.begin(), facts.end());
  facts.erase(std::unique(facts.begin(), facts.end()), facts.end());
  return facts;
}

/// Whether something that is stated about the derivation of a fact has changed: rules do not look at that again.
bool ChangeInference::touchesDerivations(const rdf::QuadDifference& change) const {
  const auto is_derivation = [&](rdf::TermId subject) { return isDerivation(reader_.viewOf(subject).text); };
  for (const std::vector<rdf::QuadIds>* quads : {&change.added, &change.removed}) {
    rdf::TermId last = rdf::kNoTerm;  // subjects stand together
    for (const rdf::QuadIds& quad : *quads)
      if (std::exchange(last, quad.s) != quad.s && is_derivation(quad.s)) return true;
  }
  return std::any_of(facts_.changed().begin(), facts_.changed().end(), [&](const auto& entry) {
    return entry.second.before != entry.second.now && is_derivation(entry.first.s);
  });
}

/// What the store holds of facts that a rule of this stage reads but may not see.
std::vector<rdf::QuadIds> ChangeInference::unseen(Stage stage, const ReadTest& reads) const {
  std::vector<rdf::QuadIds> quads;
  const auto add = [&](const Triple& fact, Stage now) {
    if (now >= stage && now != kNever && reads.matches(fact))
      quads.push_back({fact.s, fact.p, fact.o, graphs_.inferred});
  };
  for (const rdf::TermId property : reads.properties()) {
    for (const LateFact& late : facts_.lateOf(property))
      if (!facts_.changed().contains(late.fact)) add(late.fact, late.stage);
    for (const Triple& fact : facts_.changedOf(property))
      if (const FactState& state = facts_.changed().at(fact); state.is_written) add(fact, state.now);
  }
  return quads;
}

/// The facts that a rule of this stage reads and that it saw before the change and does not see now, or the other way
/// round.
std::vector<SeenChange> ChangeInference::seenChanges(Stage stage, const ReadTest& reads) const {
  std::vector<SeenChange> changes;
  for (const rdf::TermId property : reads.properties()) {
    for (const Triple& fact : facts_.changedOf(property)) {
      const FactState& state = facts_.changed().at(fact);
      if ((state.before < stage) != (state.now < stage) && reads.matches(fact))
        changes.push_back({fact, state.now != kNever});
    }
    if (const auto plain = plain_.find(property); plain != plain_.end())
      for (const SeenChange& one : plain->second)
        if (reads.matches(one.fact)) changes.push_back(one);
  }
  return changes;
}

/// The facts of the properties that the rule derives which have become known before its stage, or have ceased to be.
std::vector<Triple> ChangeInference::changedTemplateFacts(Stage stage, const RuleShape& shape) const {
  std::set<rdf::TermId> properties;
  for (const ast::TriplePattern& triple : shape.query.construct_template)
    if (const auto id = reader_.idOf(triple.predicate.term())) properties.insert(*id);
  std::vector<Triple> facts;
  for (const rdf::TermId property : properties)
    for (const Triple& fact : facts_.changedOf(property))
      if (const FactState& state = facts_.changed().at(fact); (state.before < stage) != (state.now < stage))
        facts.push_back(fact);
  std::sort(facts.begin(), facts.end());
  return facts;
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
      sink_.note(ruleFileName(shape.rule) + " is evaluated for the whole map at each change: " + shape.reason);
    }
    const std::optional<Outputs> now = solutions(stage, shape, reads, keys);
    touched = replaceOutputs(outputs, keys, *now);
  }
  const std::vector<Triple> others = changedTemplateFacts(stage, shape);
  for (const RuleOutput& output : outputs)
    if (std::binary_search(others.begin(), others.end(), output.fact)) touched.push_back(output.fact);
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
  const auto feeds = [&](const Triple& fact) { return facts_.changed().at(fact).now == stage && reads.matches(fact); };
  return std::any_of(reads.properties().begin(), reads.properties().end(), [&](rdf::TermId property) {
    const std::vector<Triple>& changed = facts_.changedOf(property);
    return std::any_of(changed.begin(), changed.end(), feeds);
  });
}

void ChangeInference::finish() {
  write();
  record_.late = facts_.lateNow();
}

/// Following a quad costs as much as inferring anew from some twelve.
bool isLarge(const rdf::WriteTransaction& transaction, const rdf::QuadDifference& change) {
  constexpr std::uint64_t kFewQuads = 1000, kShare = 12;
  const rdf::QuadReader reader(static_cast<const rdf::ReadTransaction&>(transaction));
  return change.added.size() + change.removed.size() > kFewQuads + reader.size() / kShare;
}

}  // namespace

bool inferChanges(rdf::WriteTransaction& transaction, const std::vector<NamedText>& rules, ProgressSink& sink,
                  const rdf::InferenceCheck& check) {
  const auto change = changesOf(transaction);
  if (!change || isLarge(transaction, *change)) return false;
  const InferenceGraphs graphs{rdf::QuadReader(static_cast<const rdf::ReadTransaction&>(transaction))};
  const rdf::EntrySum sum = sumBefore(sumWithout(transaction, graphs.history), *change, graphs.history);
  auto record = storedInferenceRecord(transaction, rules, sum);
  if (!record) return false;
  if (!record->reason.empty()) {
    sink.note("everything is inferred anew at each change: " + record->reason);
    return false;
  }
  const auto is_inferred = [&](const rdf::QuadIds& quad) { return quad.g == graphs.inferred; };
  if (!graphs.are_all || std::any_of(change->added.begin(), change->added.end(), is_inferred) ||
      std::any_of(change->removed.begin(), change->removed.end(), is_inferred))
    return false;
  ChangeInference inference(transaction, graphs, *record, sink, check);
  std::vector<RuleShape> shapes;
  for (const NamedText& rule : rules) shapes.push_back(shapeOf(rule));
  if (!inference.followStated(*change, shapes)) return false;
  for (std::size_t i = 0; i < shapes.size(); ++i)
    if (!inference.followRule(static_cast<Stage>(i + 1), shapes[i], record->outputs[i])) return false;
  inference.finish();
  noteIgnoredAxioms(inference.ignored(), sink);
  storeInferenceRecord(transaction, *record, rules);
  restartJournal(transaction);
  return true;
}

}  // namespace cluxel::mapping
