// SPDX-License-Identifier: Apache-2.0
// Converts librdf nodes to terms and back.
#include "rdf/redland/redland_nodes.hpp"

#include <new>

#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

const unsigned char* bytes(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

std::string_view textView(const unsigned char* text, std::size_t size) {
  return {reinterpret_cast<const char*>(text), size};
}

std::string_view textView(librdf_uri* uri) {
  std::size_t size = 0;
  const unsigned char* text = librdf_uri_as_counted_string(uri, &size);
  return textView(text, size);
}

Term literalOf(librdf_node* node) {
  std::size_t size = 0;
  const unsigned char* text = librdf_node_get_literal_value_as_counted_string(node, &size);
  const std::string_view lexical = textView(text, size);
  if (const char* language = librdf_node_get_literal_value_language(node)) return Term::langLiteral(lexical, language);
  if (librdf_uri* datatype = librdf_node_get_literal_value_datatype_uri(node))
    return Term::literal(lexical, textView(datatype));
  return Term::literal(lexical);
}

librdf_node* literalNode(librdf_world* world, const TermView& term) {
  const bool plain = term.language.empty() && term.datatype == vocabulary::xsd("string");
  const std::string language(term.language);
  // librdf expects zero-terminated text.
  const std::string text(term.text);
  librdf_node* node = librdf_new_node_from_typed_counted_literal(
      world, bytes(text), text.size(), language.empty() ? nullptr : language.c_str(), language.size(), nullptr);
  // The datatype is set afterwards: raptor's constructor normalises xsd:boolean, "1" to "true" and "maybe" to "false".
  if (node != nullptr && !plain && language.empty())
    node->value.literal.datatype = librdf_new_uri2(world, bytes(term.datatype), term.datatype.size());
  return node;
}

}  // namespace

Term termOf(librdf_node* node) {
  if (librdf_node_is_resource(node)) return Term::iri(textView(librdf_node_get_uri(node)));
  if (librdf_node_is_literal(node)) return literalOf(node);
  std::size_t size = 0;
  const unsigned char* label = librdf_node_get_counted_blank_identifier(node, &size);
  return Term::blank(textView(label, size));
}

Redland<librdf_node> nodeOf(librdf_world* world, const TermView& term) {
  librdf_node* node = nullptr;
  switch (term.kind) {
    case TermKind::Iri: {
      const std::string iri(term.text);
      node = librdf_new_node_from_counted_uri_string(world, bytes(iri), iri.size());
      break;
    }
    case TermKind::BlankNode: {
      const std::string label(term.text);
      node = librdf_new_node_from_counted_blank_identifier(world, bytes(label), label.size());
      break;
    }
    case TermKind::Literal:
      node = literalNode(world, term);
      break;
  }
  if (node == nullptr) throw std::bad_alloc();
  return Redland<librdf_node>(node);
}

}  // namespace cluxel::rdf
