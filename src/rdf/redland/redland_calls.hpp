// SPDX-License-Identifier: Apache-2.0
// librdf's read callbacks, and the common part of all callbacks: access to the map and reporting of failures to the
// logger.
#pragma once

#include <librdf.h>

#include <optional>

#include "cluxel/error.hpp"
#include "rdf/redland/redland_streams.hpp"

namespace cluxel::rdf::redland_calls {

inline RedlandMap& mapOf(librdf_storage* storage) {
  return *static_cast<RedlandMap*>(librdf_storage_get_instance(storage));
}

/// Runs `work` on the map; returns `otherwise` after a failure, which is logged.
template <typename Result, typename Work>
Result on(librdf_storage* storage, Result otherwise, const Work& work) {
  RedlandMap& map = mapOf(storage);
  return guarded(map.world(), otherwise, [&] { return work(map); });
}

/// For work without a result: returns 0, or 1 after a failure.
template <typename Work>
int run(librdf_storage* storage, const Work& work) {
  return on(storage, 1, [&](RedlandMap& map) {
    work(map);
    return 0;
  });
}

/// The non-null nodes of a statement as terms.
struct Pattern {
  std::optional<Term> s, p, o;

  explicit Pattern(librdf_statement* statement) {
    const auto bind = [](std::optional<Term>& term, librdf_node* node) {
      if (node != nullptr) term = termOf(node);
    };
    if (statement == nullptr) return;
    bind(s, librdf_statement_get_subject(statement));
    bind(p, librdf_statement_get_predicate(statement));
    bind(o, librdf_statement_get_object(statement));
  }
  static const Term* pointer(const std::optional<Term>& term) { return term ? &*term : nullptr; }
};

inline Quad quadOf(librdf_statement* statement, librdf_node* context) {
  const Pattern whole(statement);
  if (!whole.s || !whole.p || !whole.o)
    throw Error(ErrorKind::FaultyInput, "a statement without subject, predicate or object cannot be stored");
  return {*whole.s, *whole.p, *whole.o, context != nullptr ? termOf(context) : Term::iri("")};
}

int size(librdf_storage* storage);
int contains(librdf_storage* storage, librdf_statement* statement);
int hasArcIn(librdf_storage* storage, librdf_node* node, librdf_node* property);
int hasArcOut(librdf_storage* storage, librdf_node* node, librdf_node* property);
librdf_stream* find(librdf_storage* storage, librdf_statement* statement);
librdf_stream* findIn(librdf_storage* storage, librdf_statement* statement, librdf_node* context);
librdf_stream* findWithOptions(librdf_storage* storage, librdf_statement* statement, librdf_node* context,
                               librdf_hash* options);
librdf_stream* serialise(librdf_storage* storage);
librdf_stream* serialiseContext(librdf_storage* storage, librdf_node* context);
librdf_iterator* findSources(librdf_storage* storage, librdf_node* arc, librdf_node* target);
librdf_iterator* findArcs(librdf_storage* storage, librdf_node* source, librdf_node* target);
librdf_iterator* findTargets(librdf_storage* storage, librdf_node* source, librdf_node* arc);
librdf_iterator* arcsIn(librdf_storage* storage, librdf_node* node);
librdf_iterator* arcsOut(librdf_storage* storage, librdf_node* node);
librdf_iterator* contexts(librdf_storage* storage);

}  // namespace cluxel::rdf::redland_calls
