// SPDX-License-Identifier: Apache-2.0
// Follows a change through the closure and through the rules, one stage after the other.
#include <algorithm>
#include <optional>
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

/// Takes the outputs of some keys away and puts others in their place. Returns the facts of both.
std::vector<Triple> replaceOutputs(Outputs& outputs, const std::optional<std::vector<rdf::TermId>>& keys,
                                   const Outputs& now) {
  const auto is_replaced = [&](const RuleOutput& output) {
    return !keys || std::binary_search(keys->begin(), keys->end(), output.key);
  };
  std::vector<Triple> facts;
  Outputs kept;
  for (const RuleOutput& output : outputs)
    if (is_replaced(output))
      facts.push_back(output.fact);
    else
      kept.push_back(output);
  for (const RuleOutput& output : now) facts.push_back(output.fact);
  outputs.clear();
  std::merge(kept.begin(), kept.end(), now.begin(), now.end(), std::back_inserter(outputs));
  return facts;
}

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
  std::vector<Triple> statedChanges(const rdf::QuadDifference& change, const std::vector<RuleShape>& rules) const;
  void setBases(Stage stage, const RuleShape& shape, std::vector<Triple> touched, const Outputs& outputs);
  bool touchesDerivations() const;
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
  rdf::StagedClosure closure_;
};

/// The facts that were stated or withdrawn and that inference has to do with; sorted.
std::vector<Triple> ChangeInference::statedChanges(const rdf::QuadDifference& change,
                                                   const std::vector<RuleShape>& rules) const {
  const InferenceProperties properties(reader_, words_, schema_, rules);
  std::vector<Triple> facts;
  for (const std::vector<rdf::QuadIds>* quads : {&change.added, &change.removed}) {
    rdf::TermId subject = rdf::kNoTerm;
    bool is_of_derivation = false;
    for (const rdf::QuadIds& quad : *quads) {
      if (std::exchange(subject, quad.s) != quad.s) is_of_derivation = isDerivation(reader_.viewOf(quad.s).text);
      if (graphs_.isSource(quad.g) && (is_of_derivation || properties.contains(quad.p)))
        facts.push_back({quad.s, quad.p, quad.o});
    }
  }
  std::sort(facts.begin(), facts.end());
  facts.erase(std::unique(facts.begin(), facts.end()), facts.end());
  return facts;
}

bool ChangeInference::followStated(const rdf::QuadDifference& change, const std::vector<RuleShape>& rules) {
  std::vector<rdf::BaseChange> bases;
  for (const Triple& fact : statedChanges(change, rules)) {
    bool was_stated = false, is_stated = false;
    for (const rdf::TermId graph : graphs_.sources) {
      const rdf::QuadIds quad{fact.s, fact.p, fact.o, graph};
      const bool is_there = reader_.contains(quad);
      is_stated = is_stated || is_there;
      const auto& other = is_there ? change.added : change.removed;
      const bool has_changed = std::binary_search(other.begin(), other.end(), quad);
      was_stated = was_stated || is_there != has_changed;
    }
    if (was_stated == is_stated) continue;
    facts_.restate(fact, was_stated);
    bases.push_back({fact, is_stated ? 0 : kNever});
  }
  if (facts_.touchesSchema()) return false;
  closure_.update(bases);
  return !facts_.touchesSchema() && !touchesDerivations();
}

/// Whether something that is stated about the derivation of a fact has changed: rules do not look at that again.
bool ChangeInference::touchesDerivations() const {
  return std::any_of(facts_.changed().begin(), facts_.changed().end(), [&](const auto& entry) {
    return entry.second.before != entry.second.now && isDerivation(reader_.viewOf(entry.first.s).text);
  });
}

/// What the store holds of facts that a rule of this stage reads but may not see.
std::vector<rdf::QuadIds> ChangeInference::unseen(Stage stage, const ReadTest& reads) const {
  std::vector<rdf::QuadIds> quads;
  const auto add = [&](const Triple& fact, Stage now) {
    if (now >= stage && now != kNever && reads.matches(fact))
      quads.push_back({fact.s, fact.p, fact.o, graphs_.inferred});
  };
  for (const LateFact& late : facts_.lateBefore())
    if (!facts_.changed().contains(late.fact)) add(late.fact, late.stage);
  for (const auto& [fact, state] : facts_.changed())
    if (state.is_written) add(fact, state.now);
  return quads;
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
  std::vector<Triple> changed, relevant;
  for (const auto& [fact, state] : facts_.changed())
    if ((state.before < stage) != (state.now < stage)) changed.push_back(fact);
  for (const Triple& fact : changed)
    if (reads.matches(fact)) relevant.push_back(fact);
  std::vector<Triple> touched;
  if (!relevant.empty()) {
    write();
    std::optional<std::vector<rdf::TermId>> keys;
    if (shape.following == RuleShape::Following::ByKey) {
      const AffectedKeys affected(transaction_, facts_, graphs_.inferred, shape, reads, check_);
      keys = affected.of(relevant);
      constexpr std::size_t kFewKeys = 1000;  // below, evaluating by key is never worse by much
      if (keys && keys->size() > kFewKeys && keys->size() > outputs.size() / 2) keys.reset();
    } else {
      sink_.note(ruleFileName(shape.rule) + " is evaluated for the whole map at each change: " + shape.reason);
    }
    const std::optional<Outputs> now = solutions(stage, shape, reads, keys);
    touched = replaceOutputs(outputs, keys, *now);
  }
  const std::unordered_set<Triple, rdf::TripleHash> others(changed.begin(), changed.end());
  for (const RuleOutput& output : outputs)
    if (others.contains(output.fact)) touched.push_back(output.fact);
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
  return std::any_of(facts_.changed().begin(), facts_.changed().end(),
                     [&](const auto& entry) { return entry.second.now == stage && reads.matches(entry.first); });
}

void ChangeInference::finish() {
  write();
  record_.late = facts_.lateNow();
}

/// Following a quad costs as much as inferring anew from some thirteen.
bool isLarge(const rdf::WriteTransaction& transaction, const rdf::QuadDifference& change) {
  constexpr std::uint64_t kFewQuads = 1000, kShare = 13;
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
