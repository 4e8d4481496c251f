// SPDX-License-Identifier: Apache-2.0
// A rule is evaluated again until it derives nothing new.
#include "mapping/inference/sparql_rules.hpp"

#include <algorithm>
#include <unordered_set>

#include "cluxel/error.hpp"
#include "mapping/facts/query_names.hpp"
#include "mapping/inference/read_test.hpp"
#include "mapping/inference/rule_limits.hpp"
#include "mapping/statements/excluded_types.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/ontology/schema.hpp"
#include "rdf/store/quad_store.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/query_engine.hpp"
#include "sparql/syntax/parser.hpp"

namespace cluxel::mapping {

namespace {

void requireConstruct(const sparql::PreparedQuery& query, const NamedText& rule) {
  if (query.form() != sparql::ast::QueryForm::Construct)
    throw InputError({.file = rule.name}, "a SPARQL rule is a CONSTRUCT query");
}

/// A blank node in a template would get a new name in every run: two builds of one map would differ.
void refuseBlankNodes(const NamedText& rule) {
  sparql::SparqlParseOptions options;
  options.file = rule.name;
  const sparql::ast::Query query = parseQuery(rule.text, options);
  for (const sparql::ast::TriplePattern& triple : query.construct_template)
    for (const sparql::ast::PatternTerm& part : {triple.subject, triple.object})
      if (!part.isVariable() && part.term().kind == TermKind::BlankNode)
        throw InputError(locationIn(query, rule.name, part.at),
                         "the template of a SPARQL rule may not make a blank node",
                         "name the new thing by clx:newObject(class, thing) in a BIND");
}

void refuseHistory(const NamedText& rule) {
  sparql::SparqlParseOptions options;
  options.file = rule.name;
  const sparql::ast::Query query = parseQuery(rule.text, options);
  if (const auto fault = historyNamedIn(query))
    throw InputError(locationIn(query, rule.name, fault->at), fault->message, "leave the graph out");
}

/// Whether some graph but history has the fact. History is not part of the map function.
bool isKnown(const rdf::QuadReader& reader, const rdf::Triple& fact, rdf::TermId history) {
  rdf::QuadCursor cursor = reader.scan({.s = fact.s, .p = fact.p, .o = fact.o, .g = {}}, rdf::QuadOrder::Spog);
  for (rdf::QuadIds ids; cursor.next(ids);)
    if (ids.g != history) return true;
  return false;
}

std::vector<rdf::Triple> factsOf(const std::vector<RuleOutput>& outputs, const std::vector<rdf::Triple>& excluded) {
  std::vector<rdf::Triple> facts;
  facts.reserve(outputs.size());
  for (const RuleOutput& output : outputs)
    if (!std::binary_search(excluded.begin(), excluded.end(), output.fact)) facts.push_back(output.fact);
  std::sort(facts.begin(), facts.end());
  facts.erase(std::unique(facts.begin(), facts.end()), facts.end());
  return facts;
}

/// Runs the rules one after the other.
class RuleRun {
 public:
  RuleRun(rdf::WriteTransaction& transaction, const rdf::InferenceCheck& check)
      : transaction_(transaction),
        check_(check),
        reader_(static_cast<const rdf::ReadTransaction&>(transaction)),
        words_(reader_) {
    rdf::QuadWriter writer(transaction);
    inferred_ = writer.intern(Term::iri(rdf::vocabulary::kGraphInferred));
    writer.flush();
    history_ = reader_.idOf(Term::iri(rdf::vocabulary::kGraphHistory)).value_or(rdf::kNoGraph);
    record_.excluded = excludedTypes(reader_);
  }

  void run(const NamedText& rule) {
    const RuleShape shape = shapeOf(rule);
    ++stage_;
    record_.rounds.push_back(0);
    record_.outputs.emplace_back();
    for (std::uint32_t round = 0;; ++round) {
      std::vector<RuleOutput> outputs = evaluateRule(transaction_, shape, check_);
      const std::vector<rdf::QuadIds> added = derive(shape, factsOf(outputs, record_.excluded));
      record_.outputs.back() = std::move(outputs);
      record_.rounds.back() = round;
      if (added.empty()) break;
      if (round + 1 == kMaxRounds)
        throw InputError({.file = rule.name}, "derives new facts without end",
                         "a rule may not make new objects out of objects that it made itself");
      if (!mayFeed(shape, added)) break;
      if (!shape.is_monotone)
        doNotFollow(shape, shape.following == RuleShape::Following::Never ? shape.reason : "it reads what it derives");
    }
    for (const rdf::Triple& fact : closed_) record_.late.push_back({fact, stage_, false});
    closed_.clear();
    if (shape.following == RuleShape::Following::Never) doNotFollow(shape, shape.reason);
    if (shape.following == RuleShape::Following::AsWhole) addWhole(shape, shape.reason);
  }

  InferenceRecord finish() {
    if (!record_.reason.empty()) {
      record_.outputs.assign(record_.outputs.size(), {});
      record_.late.clear();
    }
    std::sort(record_.late.begin(), record_.late.end());
    return std::move(record_);
  }

 private:
  void doNotFollow(const RuleShape& shape, const std::string& reason) {
    if (record_.reason.empty()) record_.reason = ruleFileName(shape.rule) + ": " + reason;
    addWhole(shape, reason);
  }

  void addWhole(const RuleShape& shape, const std::string& reason) {
    const std::string name = ruleFileName(shape.rule);
    if (record_.whole.empty() || record_.whole.back().rule != name) record_.whole.push_back({name, reason});
  }

  /// Whether the rule may find more after these quads. One whose patterns cannot be told may.
  bool mayFeed(const RuleShape& shape, const std::vector<rdf::QuadIds>& added) const {
    const ReadTest reads(reader_, shape);
    return shape.following == RuleShape::Following::Never ||
           std::any_of(added.begin(), added.end(), [&](const rdf::QuadIds& quad) {
             return reads.matches({quad.s, quad.p, quad.o});
           });
  }

  /// Adds the new ones among the facts, their derivations and what follows; returns all that was added.
  std::vector<rdf::QuadIds> derive(const RuleShape& shape, const std::vector<rdf::Triple>& facts) {
    std::vector<rdf::QuadIds> added;
    rdf::QuadWriter writer(transaction_);
    const auto add = [&](const rdf::Triple& fact) {
      added.push_back({fact.s, fact.p, fact.o, inferred_});
      writer.add(added.back());
      record_.late.push_back({fact, stage_, true});
    };
    std::vector<rdf::Triple> fresh;
    for (const rdf::Triple& fact : facts)
      if (closed_.erase(fact) > 0 || !isKnown(reader_, fact, history_)) fresh.push_back(fact);
    constexpr std::size_t kBytesOfDerivedFact = 2000;  // six quads with their terms
    if (check_) check_(fresh.size() * kBytesOfDerivedFact);
    for (const rdf::Triple& fact : fresh) {
      add(fact);
      for (const rdf::Triple& part : derivationOf(reader_, writer, fact, shape.rule))
        if (!isKnown(reader_, part, history_)) add(part);
    }
    writer.flush();
    if (added.empty()) return added;
    for (const rdf::QuadIds& quad : extendClosure(transaction_, added, check_).extension) {
      closed_.insert({quad.s, quad.p, quad.o});
      added.push_back(quad);
    }
    for (const rdf::QuadIds& quad : added)
      if (words_.isAxiom(quad.p, quad.o)) doNotFollow(shape, "it derives axioms");
    return added;
  }

  rdf::WriteTransaction& transaction_;
  const rdf::InferenceCheck& check_;
  rdf::QuadReader reader_;
  rdf::SchemaWords words_;
  rdf::TermId inferred_ = rdf::kNoTerm, history_ = rdf::kNoGraph;
  rdf::Stage stage_ = 0;
  /// Facts of this stage by the closure. A later round of the rule may derive them, too.
  std::unordered_set<rdf::Triple, rdf::TripleHash> closed_;
  InferenceRecord record_;
};

}  // namespace

void checkSparqlRules(const std::vector<NamedText>& rules) {
  const auto scratch = rdf::Environment::temporary();
  const rdf::QuadReader reader(scratch->read());
  for (const NamedText& rule : rules) {
    requireConstruct(sparql::PreparedQuery(reader, rule.text, ruleOptions(rule)), rule);
    refuseBlankNodes(rule);
  }
}

void checkNewSparqlRules(const std::vector<NamedText>& rules) {
  checkSparqlRules(rules);
  for (const NamedText& rule : rules) {
    refuseUnboundPaths(shapeOf(rule).query, rule);
    refuseHistory(rule);
  }
}

void noteUnknownNames(const std::vector<NamedText>& rules, const rdf::OntologyView& ontology, ProgressSink& sink) {
  for (const NamedText& rule : rules)
    for (const Diagnostic& fault : checkRuleNames(rule.name, rule.text, ontology))
      sink.note(toString(fault.location) + ": " + fault.message);
}

InferenceRecord runSparqlRules(rdf::WriteTransaction& transaction, const std::vector<NamedText>& rules,
                               const rdf::InferenceCheck& check) {
  RuleRun run(transaction, check);
  for (const NamedText& rule : rules) run.run(rule);
  return run.finish();
}

}  // namespace cluxel::mapping
