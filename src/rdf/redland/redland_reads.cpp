// SPDX-License-Identifier: Apache-2.0
// librdf's read callbacks.
#include <algorithm>
#include <limits>

#include "rdf/redland/redland_calls.hpp"

namespace cluxel::rdf::redland_calls {

int size(librdf_storage* storage) {
  return on(storage, -1, [](RedlandMap& map) {
    const QuadReader reader(map.read());
    const std::uint64_t count =
        map.options().strict ? reader.count({.s = {}, .p = {}, .o = {}, .g = kNoTerm}) : reader.size();
    return static_cast<int>(std::min<std::uint64_t>(count, std::numeric_limits<int>::max()));
  });
}

int contains(librdf_storage* storage, librdf_statement* statement) {
  return on(storage, 0, [&](RedlandMap& map) {
    const Quad quad = quadOf(statement, nullptr);
    return map.find(&quad.subject, &quad.predicate, &quad.object)->atEnd() ? 0 : 1;
  });
}

librdf_stream* findIn(librdf_storage* storage, librdf_statement* statement, librdf_node* context) {
  return on(storage, static_cast<librdf_stream*>(nullptr), [&](RedlandMap& map) {
    const Pattern bound(statement);
    const Term* s = Pattern::pointer(bound.s);
    const Term* p = Pattern::pointer(bound.p);
    const Term* o = Pattern::pointer(bound.o);
    return streamOf(map.world(), storage,
                    context != nullptr ? map.findIn(termOf(context), s, p, o) : map.find(s, p, o));
  });
}

librdf_stream* find(librdf_storage* storage, librdf_statement* statement) {
  return findIn(storage, statement, nullptr);
}

librdf_stream* findWithOptions(librdf_storage* storage, librdf_statement* statement, librdf_node* context,
                               librdf_hash*) {
  return findIn(storage, statement, context);
}

librdf_stream* serialise(librdf_storage* storage) {
  return on(storage, static_cast<librdf_stream*>(nullptr),
            [&](RedlandMap& map) { return streamOf(map.world(), storage, map.all()); });
}

librdf_stream* serialiseContext(librdf_storage* storage, librdf_node* context) {
  return findIn(storage, nullptr, context);
}

namespace {

/// The distinct nodes at one position of the matching triples, sorted by term.
librdf_iterator* nodesAt(librdf_storage* storage, librdf_node* s, librdf_node* p, librdf_node* o,
                         TermId QuadIds::*place) {
  return on(storage, static_cast<librdf_iterator*>(nullptr), [&](RedlandMap& map) {
    const auto term = [](librdf_node* node) { return node != nullptr ? std::optional(termOf(node)) : std::nullopt; };
    const std::optional<Term> subject = term(s);
    const std::optional<Term> predicate = term(p);
    const std::optional<Term> object = term(o);
    const auto found = map.find(Pattern::pointer(subject), Pattern::pointer(predicate), Pattern::pointer(object));
    std::vector<TermId> ids;
    for (; !found->atEnd(); found->next()) ids.push_back(found->quad().*place);
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    std::vector<Term> nodes;
    nodes.reserve(ids.size());
    for (const TermId id : ids) nodes.push_back(found->viewOf(id).toTerm());
    std::sort(nodes.begin(), nodes.end());
    return iteratorOf(map.world(), storage, std::move(nodes));
  });
}

}  // namespace

librdf_iterator* findSources(librdf_storage* storage, librdf_node* arc, librdf_node* target) {
  return nodesAt(storage, nullptr, arc, target, &QuadIds::s);
}

librdf_iterator* findArcs(librdf_storage* storage, librdf_node* source, librdf_node* target) {
  return nodesAt(storage, source, nullptr, target, &QuadIds::p);
}

librdf_iterator* findTargets(librdf_storage* storage, librdf_node* source, librdf_node* arc) {
  return nodesAt(storage, source, arc, nullptr, &QuadIds::o);
}

librdf_iterator* arcsIn(librdf_storage* storage, librdf_node* node) {
  return nodesAt(storage, nullptr, nullptr, node, &QuadIds::p);
}

librdf_iterator* arcsOut(librdf_storage* storage, librdf_node* node) {
  return nodesAt(storage, node, nullptr, nullptr, &QuadIds::p);
}

int hasArcIn(librdf_storage* storage, librdf_node* node, librdf_node* property) {
  return on(storage, 0, [&](RedlandMap& map) {
    const Term object = termOf(node);
    const Term predicate = termOf(property);
    return map.find(nullptr, &predicate, &object)->atEnd() ? 0 : 1;
  });
}

int hasArcOut(librdf_storage* storage, librdf_node* node, librdf_node* property) {
  return on(storage, 0, [&](RedlandMap& map) {
    const Term subject = termOf(node);
    const Term predicate = termOf(property);
    return map.find(&subject, &predicate, nullptr)->atEnd() ? 0 : 1;
  });
}

librdf_iterator* contexts(librdf_storage* storage) {
  return on(storage, static_cast<librdf_iterator*>(nullptr), [&](RedlandMap& map) {
    const QuadReader reader(map.read());
    std::vector<Term> graphs;
    for (const TermId id : reader.graphs())
      if (id != kNoTerm) graphs.push_back(reader.termOf(id));
    std::sort(graphs.begin(), graphs.end());
    return iteratorOf(map.world(), storage, std::move(graphs));
  });
}

}  // namespace cluxel::rdf::redland_calls
