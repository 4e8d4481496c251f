// SPDX-License-Identifier: Apache-2.0
// Conversion between librdf's nodes and the store's terms.
#pragma once

#include <librdf.h>

#include <memory>

#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

struct RedlandDeleter {
  void operator()(librdf_node* node) const { librdf_free_node(node); }
  void operator()(librdf_uri* uri) const { librdf_free_uri(uri); }
  void operator()(librdf_statement* statement) const { librdf_free_statement(statement); }
  void operator()(char* text) const { librdf_free_memory(text); }
};
template <typename T>
using Redland = std::unique_ptr<T, RedlandDeleter>;

Term termOf(librdf_node* node);
/// An xsd:string becomes a plain literal, as librdf's users expect it.
Redland<librdf_node> nodeOf(librdf_world* world, const TermView& term);

}  // namespace cluxel::rdf
