// SPDX-License-Identifier: Apache-2.0
// A solution differs only when a fact that one of its patterns matches does. The pattern's variable gives the key, or
// is led to it by a query over the facts of before and now together.
#include "mapping/inference/affected_keys.hpp"

#include <map>

#include "mapping/inference/temporary_quads.hpp"

namespace cluxel::mapping {

/// Adds all ends of the path's steps that are connected with the fact by such steps, now or before.
void AffectedKeys::addConnected(const rdf::Triple& fact, std::size_t read, std::set<rdf::TermId>& reached) const {
  std::vector<rdf::TermId> open;
  const auto reach = [&](rdf::TermId node) {
    if (reached.insert(node).second) open.push_back(node);
  };
  reach(fact.s), reach(fact.o);
  while (!open.empty()) {
    const rdf::TermId node = open.back();
    open.pop_back();
    for (const rdf::TermId link : reads_.linksOf(read)) {
      facts_.forEachObject(node, link, [&](rdf::TermId end, const rdf::FactState&) { reach(end); });
      facts_.forEachSubject(link, node, [&](rdf::TermId end, const rdf::FactState&) { reach(end); });
    }
  }
}

/// Whether the pattern's subject leads to the key, rather than its object. None: it has no variable.
std::optional<bool> AffectedKeys::goesBySubject(std::size_t read) const {
  const ast::TriplePattern& triple = shape_.reads[read].triple;
  const auto is_key = [&](const ast::PatternTerm& end) { return end.isVariable() && end.variable() == shape_.key; };
  if (!triple.subject.isVariable() && !triple.object.isVariable()) return std::nullopt;
  return is_key(triple.subject) || (triple.subject.isVariable() && !is_key(triple.object));
}

/// Whether the value has the types, and other constant objects, that each solution needs of the variable: before the
/// change or now. False: no solution has or had this value.
bool AffectedKeys::hasConstants(ast::VariableIndex variable, rdf::TermId value) const {
  for (std::size_t read = 0; read < shape_.reads.size(); ++read) {
    const ReadPattern& pattern = shape_.reads[read];
    const bool is_about = !pattern.triple.isPath() && pattern.triple.subject.isVariable() &&
                          pattern.triple.subject.variable() == variable && !pattern.triple.object.isVariable();
    if (pattern.need != ReadPattern::Need::Always || !is_about) continue;
    const auto wanted = reads_.patternOf(read);
    if (!wanted) return false;
    const rdf::FactState state = facts_.stateOf({value, wanted->p, wanted->o});
    if (state.before == rdf::kNever && state.now == rdf::kNever) return false;
  }
  return true;
}

bool AffectedKeys::mayBind(ast::VariableIndex variable, rdf::TermId value) {
  const auto [known, is_new] = may_bind_.try_emplace(std::uint64_t{variable} << 32U | value);
  if (is_new) known->second = hasConstants(variable, value);
  return known->second;
}

/// Whether a solution can have the fact for a pattern.
bool AffectedKeys::mayMatch(std::size_t read, const rdf::Triple& fact) {
  const ast::TriplePattern& triple = shape_.reads[read].triple;
  if (!reads_.matches(read, fact)) return false;
  if (triple.isPath()) return true;
  return (!triple.subject.isVariable() || mayBind(triple.subject.variable(), fact.s)) &&
         (!triple.object.isVariable() || mayBind(triple.object.variable(), fact.o));
}

/// Of the facts that have ceased to be, those that solutions had.
std::vector<rdf::QuadIds> AffectedKeys::goneAmong(const std::vector<SeenChange>& changed) {
  std::vector<rdf::QuadIds> gone;
  for (const auto& [fact, is_fact] : changed)
    for (std::size_t read = 0; !is_fact && read < shape_.reads.size(); ++read)
      if (mayMatch(read, fact)) {
        gone.push_back({fact.s, fact.p, fact.o, inferred_});
        break;
      }
  return gone;
}

std::optional<std::vector<rdf::TermId>> AffectedKeys::of(const std::vector<SeenChange>& changed) {
  std::map<ast::VariableIndex, std::set<rdf::TermId>> values;
  for (std::size_t read = 0; read < shape_.reads.size(); ++read) {
    const ast::TriplePattern& triple = shape_.reads[read].triple;
    const auto by_subject = goesBySubject(read);
    std::set<rdf::TermId> ends;
    for (const auto& [fact, is_fact] : changed) {
      if (!mayMatch(read, fact)) continue;
      if (!by_subject) return std::nullopt;
      if (triple.isPath())
        addConnected(fact, read, ends);
      else
        ends.insert(*by_subject ? fact.s : fact.o);
    }
    if (ends.empty()) continue;
    const ast::VariableIndex variable = (*by_subject ? triple.subject : triple.object).variable();
    std::erase_if(ends, [&](rdf::TermId end) { return !mayBind(variable, end); });
    if (!ends.empty()) values[variable].merge(ends);
  }
  std::set<rdf::TermId> keys = std::move(values[shape_.key]);
  values.erase(shape_.key);
  if (values.empty()) return std::vector<rdf::TermId>(keys.begin(), keys.end());
  TemporaryQuads before(transaction_, goneAmong(changed), {});
  const rdf::QuadReader reader{static_cast<const rdf::ReadTransaction&>(transaction_)};
  for (const auto& [variable, ids] : values) {
    ValuesOf some{variable, {}};
    for (const rdf::TermId id : ids) some.terms.push_back(reader.termOf(id));
    for (const rdf::TermId key : affectedKeys(reader, shape_, some, check_)) keys.insert(key);
  }
  before.end();
  return std::vector<rdf::TermId>(keys.begin(), keys.end());
}

}  // namespace cluxel::mapping
