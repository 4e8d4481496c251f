// SPDX-License-Identifier: Apache-2.0
// Graph `observed`, which an update cannot write, tells to which object a statement applies.
#include "mapping/statements/deleted_statements.hpp"

#include "cluxel/error.hpp"
#include "mapping/statements/named_resources.hpp"
#include "mapping/statements/statement_history.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace {

/// The statement that quads about one subject are; none when it is malformed.
std::vector<Statement> wellFormedStatement(const std::vector<Quad>& quads) {
  try {
    return statementsAmong(quads);
  } catch (const Error& fault) {
    if (fault.kind() != ErrorKind::FaultyInput) throw;
    return {};
  }
}

/// Reads each statement by itself, so that a malformed one hides no other.
std::vector<Statement> wellFormedStatements(const rdf::QuadReader& reader) {
  std::vector<Statement> statements;
  const std::string_view graph_iri = rdf::vocabulary::kGraphOperator;
  const auto graph = reader.idOf(Term::iri(graph_iri));
  const auto type = reader.idOf(Term::iri(rdf::vocabulary::rdf("type")));
  const auto kind = reader.idOf(Term::iri(rdf::vocabulary::clx("OperatorStatement")));
  if (!graph || !type || !kind) return statements;
  rdf::QuadCursor cursor = reader.scan({.s = {}, .p = *type, .o = *kind, .g = *graph});
  for (rdf::QuadIds quad; cursor.next(quad);)
    for (Statement& statement : wellFormedStatement(quadsAbout(reader, reader.termOf(quad.s).text, graph_iri)))
      statements.push_back(std::move(statement));
  return statements;
}

}  // namespace

DeletedStatements::DeletedStatements(const rdf::ReadTransaction& transaction) : transaction_(transaction) {
  for (const Statement& statement : wellFormedStatements(rdf::QuadReader(transaction)))
    if (statement.kind == StatementKind::Is)
      saying_[{rdf::vocabulary::rdf("type"), statement.value}].statements.push_back(statement.id());
    else if (statement.kind == StatementKind::Fact)
      saying_[{statement.property, statement.value}].statements.push_back(statement.id());
}

const DeletedStatements::ByObject& DeletedStatements::byObject(Saying& saying) const {
  if (saying.by_object) return *saying.by_object;
  ByObject& by_object = saying.by_object.emplace();
  const Term applies_to = Term::iri(rdf::vocabulary::clx("appliesTo"));
  const rdf::QuadReader reader(transaction_);
  for (const ContentHash& id : saying.statements)
    for (const Quad& quad : quadsAbout(reader, rdf::iriOfStatement(id), rdf::vocabulary::kGraphObserved))
      if (quad.predicate == applies_to) by_object[quad.object.text].push_back(id);
  return by_object;
}

std::vector<ContentHash> DeletedStatements::thatSay(const Quad& triple) {
  if (saying_.empty()) return {};
  const auto found = saying_.find({triple.predicate.text, triple.object});
  if (found == saying_.end() || !namesObject(triple.subject)) return {};
  if (!known_) known_.emplace(transaction_);
  const auto object = known_->find(triple.subject.text);
  if (!object) return {};
  const ByObject& by_object = byObject(found->second);
  const auto about = by_object.find(rdf::iriOfObject(*object));
  return about == by_object.end() ? std::vector<ContentHash>() : about->second;
}

void DeletedStatements::add(const Quad& quad) {
  for (const ContentHash& id : thatSay(quad)) deleted_.emplace_back(quad, id);
}

std::size_t DeletedStatements::withdraw(rdf::WriteTransaction& transaction, ProgressSink& sink) const {
  std::set<ContentHash> withdrawn;
  {
    const rdf::QuadReader now(static_cast<const rdf::ReadTransaction&>(transaction));
    const auto isThere = [&](const Quad& quad) {
      const auto subject = now.idOf(quad.subject), predicate = now.idOf(quad.predicate), object = now.idOf(quad.object),
                 graph = now.idOf(quad.graph);
      return subject && predicate && object && graph && now.contains({*subject, *predicate, *object, *graph});
    };
    const auto isStored = [&](const ContentHash& id) {
      return !quadsAbout(now, rdf::iriOfStatement(id), rdf::vocabulary::kGraphOperator).empty();
    };
    for (const auto& [quad, id] : deleted_)
      if (isStored(id) && !isThere(quad)) withdrawn.insert(id);
  }
  eraseStatements(transaction, std::vector<ContentHash>(withdrawn.begin(), withdrawn.end()));
  if (!withdrawn.empty())
    sink.note("what was to be deleted is said by " +
              (withdrawn.size() > 1 ? std::to_string(withdrawn.size()) + " operator statements, such as "
                                    : std::string("the operator statement ")) +
              withdrawn.begin()->hex() + (withdrawn.size() > 1 ? ": they are withdrawn" : ": it is withdrawn"));
  return withdrawn.size();
}

std::string DeletedStatements::remedyFor(const Quad& triple) {
  const std::vector<ContentHash> saying = thatSay(triple);
  if (saying.empty()) return "";
  return "the operator statement " + saying.front().hex() +
         " says this: withdraw it. A deletion of the same from graph operator does so, too: write GRAPH <" +
         std::string(rdf::vocabulary::kGraphOperator) + "> { ... } in the data or the template, or WITH before it";
}

}  // namespace cluxel::mapping
