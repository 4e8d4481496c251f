// SPDX-License-Identifier: Apache-2.0
// Graph `observed`, which an update cannot write, tells to which object a statement applies.
#include "mapping/statements/deleted_statements.hpp"

#include <algorithm>

#include "cluxel/error.hpp"
#include "mapping/statements/named_resources.hpp"
#include "mapping/statements/statement_history.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace {

std::vector<Statement> wellFormedStatements(const rdf::ReadTransaction& transaction) {
  try {
    return storedStatements(rdf::QuadReader(transaction));
  } catch (const Error& fault) {
    if (fault.kind() != ErrorKind::FaultyInput) throw;
    return {};
  }
}

}  // namespace

DeletedStatements::DeletedStatements(const rdf::ReadTransaction& transaction) : transaction_(transaction) {
  for (const Statement& statement : wellFormedStatements(transaction))
    if (statement.kind == StatementKind::Is)
      saying_[{rdf::vocabulary::rdf("type"), statement.value}].push_back(statement.id());
    else if (statement.kind == StatementKind::Fact)
      saying_[{statement.property, statement.value}].push_back(statement.id());
}

std::vector<ContentHash> DeletedStatements::thatSay(const Quad& triple) {
  std::vector<ContentHash> saying;
  if (saying_.empty()) return saying;
  const auto found = saying_.find({triple.predicate.text, triple.object});
  if (found == saying_.end() || !namesObject(triple.subject)) return saying;
  if (!known_) known_.emplace(transaction_);
  const auto object = known_->find(triple.subject.text);
  if (!object) return saying;
  const Term applies_to = Term::iri(rdf::vocabulary::clx("appliesTo")), meant = Term::iri(rdf::iriOfObject(*object));
  const rdf::QuadReader reader(transaction_);
  for (const ContentHash& id : found->second) {
    const auto about = quadsAbout(reader, rdf::iriOfStatement(id), rdf::vocabulary::kGraphObserved);
    if (std::any_of(about.begin(), about.end(),
                    [&](const Quad& quad) { return quad.predicate == applies_to && quad.object == meant; }))
      saying.push_back(id);
  }
  return saying;
}

void DeletedStatements::add(const Quad& quad) {
  for (const ContentHash& id : thatSay(quad)) deleted_.emplace_back(quad, id);
}

std::size_t DeletedStatements::withdraw(rdf::WriteTransaction& transaction, ProgressSink& sink) const {
  std::set<ContentHash> withdrawn;
  {
    const rdf::QuadReader now(static_cast<const rdf::ReadTransaction&>(transaction));
    const auto isThere = [&](const Quad& quad) {
      const auto about = quadsAbout(now, quad.subject.text, rdf::vocabulary::kGraphOperator);
      return std::find(about.begin(), about.end(), quad) != about.end();
    };
    const auto isStored = [&](const ContentHash& id) {
      return !quadsAbout(now, rdf::iriOfStatement(id), rdf::vocabulary::kGraphOperator).empty();
    };
    for (const auto& [quad, id] : deleted_)
      if (isStored(id) && !isThere(quad)) withdrawn.insert(id);
  }
  for (const ContentHash& id : withdrawn) eraseStatement(transaction, id);
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
