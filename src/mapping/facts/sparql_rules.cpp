// SPDX-License-Identifier: Apache-2.0
// A rule is evaluated again until it derives nothing new.
#include "mapping/facts/sparql_rules.hpp"

#include "cluxel/error.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/store/quad_store.hpp"
#include "sparql/query_engine.hpp"
#include "sparql/syntax/parser.hpp"

namespace cluxel::mapping {

namespace {

sparql::QueryOptions ruleOptions(const NamedText& rule) {
  sparql::QueryOptions options;
  options.refuse_volatile = true;
  options.source_name = rule.name;
  return options;
}

void requireConstruct(const sparql::PreparedQuery& query, const NamedText& rule) {
  if (query.form() != sparql::ast::QueryForm::Construct)
    throw InputError({.file = rule.name}, "a SPARQL rule is a CONSTRUCT query");
}

/// A blank node in a template would get a new name in every run: two builds of one map would differ.
void refuseBlankNodes(const NamedText& rule) {
  sparql::SparqlParseOptions options;
  options.file = rule.name;
  const auto isBlank = [](const sparql::ast::PatternTerm& part) {
    return !part.isVariable() && part.term().kind == TermKind::BlankNode;
  };
  for (const sparql::ast::TriplePattern& triple : parseQuery(rule.text, options).construct_template)
    if (isBlank(triple.subject) || isBlank(triple.object))
      throw InputError({.file = rule.name}, "the template of a SPARQL rule may not make a blank node",
                       "name the new thing by clx:newObject(class, thing) in a BIND");
}

/// Whether some graph but history has the fact. History is not part of the map function.
bool isKnown(const rdf::QuadReader& reader, const Quad& quad) {
  rdf::QuadPattern pattern;
  pattern.s = reader.idOf(quad.subject);
  pattern.p = reader.idOf(quad.predicate);
  pattern.o = reader.idOf(quad.object);
  if (!pattern.s || !pattern.p || !pattern.o) return false;
  const auto history = reader.idOf(Term::iri(rdf::vocabulary::kGraphHistory));
  rdf::QuadCursor cursor = reader.scan(pattern);
  for (rdf::QuadIds ids; cursor.next(ids);)
    if (!history || ids.g != *history) return true;
  return false;
}

/// Adds quads to graph inferred, and notes them.
class InferredWriter {
 public:
  explicit InferredWriter(rdf::WriteTransaction& transaction) : writer_(transaction) {}
  void add(const Quad& quad) {
    added_.push_back({writer_.intern(quad.subject), writer_.intern(quad.predicate), writer_.intern(quad.object),
                      writer_.intern(quad.graph)});
    writer_.add(added_.back());
  }
  std::vector<rdf::QuadIds> finish() {
    writer_.flush();
    return std::move(added_);
  }

 private:
  rdf::QuadWriter writer_;
  std::vector<rdf::QuadIds> added_;
};

/// Adds the resource that records the rule of a derived fact.
void addDerivation(InferredWriter& writer, const Quad& fact, const NamedText& rule) {
  const std::string name = ruleFileName(rule);
  const ContentHash id = ContentHasher()
                             .addText(name)
                             .addText(toNTriples(fact.subject))
                             .addText(toNTriples(fact.predicate))
                             .addText(toNTriples(fact.object))
                             .finish();
  const Term node = Term::iri(rdf::iriOfDerivation(id));
  const auto add = [&](const std::string& property, const Term& object) {
    writer.add(Quad{node, Term::iri(property), object, fact.graph});
  };
  add(rdf::vocabulary::rdf("type"), Term::iri(rdf::vocabulary::clx("Derivation")));
  add(rdf::vocabulary::rdf("subject"), fact.subject);
  add(rdf::vocabulary::rdf("predicate"), fact.predicate);
  add(rdf::vocabulary::rdf("object"), fact.object);
  add(rdf::vocabulary::clx("rule"), Term::literal(name));
}

/// Evaluates one rule once, and tells what it added; nothing when it derived nothing new.
std::vector<rdf::QuadIds> deriveOnce(rdf::WriteTransaction& transaction, const NamedText& rule,
                                     const rdf::InferenceCheck& check) {
  const rdf::QuadReader reader{static_cast<const rdf::ReadTransaction&>(transaction)};
  sparql::QueryOptions options = ruleOptions(rule);
  if (check) {
    options.budget.poll = [&check] { check(0); };
    options.budget.max_memory_bytes = check.max_memory_bytes;
  }
  sparql::PreparedQuery query(reader, rule.text, options);
  requireConstruct(query, rule);
  std::vector<Quad> fresh;
  for (Quad& fact : query.evaluate().graph)
    if (!isKnown(reader, fact)) fresh.push_back(std::move(fact));
  constexpr std::size_t kBytesOfDerivedFact = 2000;  // six quads with their terms
  if (check) check(fresh.size() * kBytesOfDerivedFact);
  InferredWriter writer(transaction);
  for (Quad& fact : fresh) {
    fact.graph = Term::iri(rdf::vocabulary::kGraphInferred);
    writer.add(fact);
    addDerivation(writer, fact, rule);
  }
  return writer.finish();
}

}  // namespace

void checkSparqlRules(const std::vector<NamedText>& rules) {
  const auto scratch = rdf::Environment::temporary();
  const rdf::QuadReader reader(scratch->read());
  for (const NamedText& rule : rules) {
    requireConstruct(sparql::PreparedQuery(reader, rule.text, ruleOptions(rule)), rule);
    refuseBlankNodes(rule);
  }
}

void runSparqlRules(rdf::WriteTransaction& transaction, const std::vector<NamedText>& rules,
                    const rdf::InferenceCheck& check) {
  constexpr int kMaxRounds = 1000;
  for (const NamedText& rule : rules) {
    int round = 0;
    while (true) {
      const std::vector<rdf::QuadIds> added = deriveOnce(transaction, rule, check);
      if (added.empty()) break;
      extendClosure(transaction, added, check);
      if (++round == kMaxRounds)
        throw InputError({.file = rule.name}, "derives new facts without end",
                         "a rule may not make new objects out of objects that it made itself");
    }
  }
}

}  // namespace cluxel::mapping
