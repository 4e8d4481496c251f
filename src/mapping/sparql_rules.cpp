// SPDX-License-Identifier: Apache-2.0
// Fixpoints over the store: a rule is asked again until its answer holds nothing new.
#include "mapping/sparql_rules.hpp"

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/knowledge/ontology.hpp"
#include "cluxel/knowledge/quad_store.hpp"
#include "cluxel/knowledge/vocabulary.hpp"
#include "cluxel/sparql/parser.hpp"
#include "cluxel/sparql/query_engine.hpp"

namespace cluxel {

namespace {

QueryOptions ruleOptions(const NamedText& rule) {
  QueryOptions options;
  options.refuse_volatile = true;
  options.source_name = rule.name;
  return options;
}

void requireConstruct(const PreparedQuery& query, const NamedText& rule) {
  if (query.form() != ast::QueryForm::Construct)
    throw InputError({.file = rule.name}, "a SPARQL rule is a CONSTRUCT query");
}

/// A blank node of a template is a new one in every run: the same map would never come out twice.
void refuseBlankNodes(const NamedText& rule) {
  SparqlParseOptions options;
  options.file = rule.name;
  const auto isBlank = [](const ast::PatternTerm& part) {
    return !part.isVariable() && part.term().kind == TermKind::BlankNode;
  };
  for (const ast::TriplePattern& triple : parseQuery(rule.text, options).construct_template)
    if (isBlank(triple.subject) || isBlank(triple.object))
      throw InputError({.file = rule.name}, "the template of a SPARQL rule may not make a blank node",
                       "name the new thing by clx:newObject(class, thing) in a BIND");
}

/// Whether a graph says so already. What the history of builds says is not part of the map.
bool isKnown(const QuadReader& reader, const Quad& quad) {
  QuadPattern pattern;
  pattern.s = reader.idOf(quad.subject);
  pattern.p = reader.idOf(quad.predicate);
  pattern.o = reader.idOf(quad.object);
  if (!pattern.s || !pattern.p || !pattern.o) return false;
  const auto history = reader.idOf(Term::iri(vocabulary::kGraphHistory));
  QuadCursor cursor = reader.scan(pattern);
  for (QuadIds ids; cursor.next(ids);)
    if (!history || ids.g != *history) return true;
  return false;
}

/// The resource that says which rule a fact comes from.
void addDerivation(QuadWriter& writer, const Quad& fact, const NamedText& rule) {
  const std::string name = ruleFileName(rule);
  const ContentHash id = ContentHasher()
                             .addText(name)
                             .addText(toNTriples(fact.subject))
                             .addText(toNTriples(fact.predicate))
                             .addText(toNTriples(fact.object))
                             .finish();
  const Term node = Term::iri(std::string(vocabulary::kMap) + "derivation/" + id.hex());
  const auto add = [&](const std::string& property, const Term& object) {
    writer.add(Quad{node, Term::iri(property), object, fact.graph});
  };
  add(vocabulary::rdf("type"), Term::iri(vocabulary::clx("Derivation")));
  add(vocabulary::rdf("subject"), fact.subject);
  add(vocabulary::rdf("predicate"), fact.predicate);
  add(vocabulary::rdf("object"), fact.object);
  add(vocabulary::clx("rule"), Term::literal(name));
}

/// One round of one rule; false when it found nothing new.
bool deriveOnce(WriteTransaction& transaction, const NamedText& rule) {
  const QuadReader reader{static_cast<const ReadTransaction&>(transaction)};
  PreparedQuery query(reader, rule.text, ruleOptions(rule));
  requireConstruct(query, rule);
  std::vector<Quad> fresh;
  for (Quad& fact : query.evaluate().graph)
    if (!isKnown(reader, fact)) fresh.push_back(std::move(fact));
  QuadWriter writer(transaction);
  for (Quad& fact : fresh) {
    fact.graph = Term::iri(vocabulary::kGraphInferred);
    writer.add(fact);
    addDerivation(writer, fact, rule);
  }
  writer.flush();
  return !fresh.empty();
}

}  // namespace

void checkSparqlRules(const std::vector<NamedText>& rules) {
  const auto scratch = Environment::temporary();
  const QuadReader reader(scratch->read());
  for (const NamedText& rule : rules) {
    requireConstruct(PreparedQuery(reader, rule.text, ruleOptions(rule)), rule);
    refuseBlankNodes(rule);
  }
}

void runSparqlRules(WriteTransaction& transaction, const std::vector<NamedText>& rules) {
  constexpr int kMostRounds = 1000;
  for (const NamedText& rule : rules) {
    int round = 0;
    while (deriveOnce(transaction, rule)) {
      extendClosure(transaction);
      if (++round == kMostRounds)
        throw InputError({.file = rule.name}, "derives new facts without end",
                         "a rule may not make new objects out of objects that it made itself");
    }
  }
}

}  // namespace cluxel
