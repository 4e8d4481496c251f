// SPDX-License-Identifier: Apache-2.0
// Rows and triples of an answer as librdf's nodes, statements and streams.
#include "sparql/redland_answer.hpp"

#include <cstring>

#include "cluxel/knowledge/vocabulary.hpp"

namespace cluxel {
namespace {

const unsigned char* bytes(const std::string& text) {
  return reinterpret_cast<const unsigned char*>(text.c_str());
}
std::string textOf(const unsigned char* text) {
  return text == nullptr ? "" : reinterpret_cast<const char*>(text);
}

struct StreamPlace {
  RedlandAnswer* answer;
  std::size_t next = 0;
  librdf_statement* current = nullptr;

  void drop() {
    if (current != nullptr) librdf_free_statement(current);
    current = nullptr;
  }
};

StreamPlace& placeOf(void* context) {
  return *static_cast<StreamPlace*>(context);
}

int streamIsEnd(void* context) {
  const StreamPlace& place = placeOf(context);
  return place.next >= place.answer->result().graph.size() ? 1 : 0;
}

int streamNext(void* context) {
  StreamPlace& place = placeOf(context);
  place.drop();
  ++place.next;
  return streamIsEnd(context);
}

void* streamGet(void* context, int what) {
  StreamPlace& place = placeOf(context);
  if (what != LIBRDF_ITERATOR_GET_METHOD_GET_OBJECT || streamIsEnd(context) != 0) return nullptr;
  if (place.current == nullptr) place.current = place.answer->statement(place.next);
  return place.current;
}

void streamFinished(void* context) {
  placeOf(context).drop();
  delete static_cast<StreamPlace*>(context);
}

}  // namespace

librdf_node* newRedlandNode(librdf_world* world, const Term& term) {
  if (term.kind == TermKind::Iri) return librdf_new_node_from_uri_string(world, bytes(term.text));
  if (term.kind == TermKind::BlankNode) return librdf_new_node_from_blank_identifier(world, bytes(term.text));
  if (!term.language.empty()) return librdf_new_node_from_literal(world, bytes(term.text), term.language.c_str(), 0);
  if (term.datatype == vocabulary::xsd("string"))
    return librdf_new_node_from_literal(world, bytes(term.text), nullptr, 0);
  librdf_uri* datatype = librdf_new_uri(world, bytes(term.datatype));
  librdf_node* node = librdf_new_node_from_typed_literal(world, bytes(term.text), nullptr, datatype);
  librdf_free_uri(datatype);
  return node;
}

Term redlandTerm(librdf_node* node) {
  if (librdf_node_is_resource(node) != 0) return Term::iri(textOf(librdf_uri_as_string(librdf_node_get_uri(node))));
  if (librdf_node_is_blank(node) != 0) return Term::blank(textOf(librdf_node_get_blank_identifier(node)));
  const std::string text = textOf(librdf_node_get_literal_value(node));
  if (const char* language = librdf_node_get_literal_value_language(node)) return Term::langLiteral(text, language);
  librdf_uri* datatype = librdf_node_get_literal_value_datatype_uri(node);
  return datatype == nullptr ? Term::literal(text) : Term::literal(text, textOf(librdf_uri_as_string(datatype)));
}

RedlandAnswer::RedlandAnswer(librdf_world* world, QueryResult result) : world_(world), result_(std::move(result)) {
  for (const std::string& name : result_.table.variables) names_.push_back(name.c_str());
  names_.push_back(nullptr);
}

librdf_node* RedlandAnswer::value(std::size_t column) const {
  if (finished() || column >= columns()) return nullptr;
  const Term* term = result_.table.at(row_, column);
  return term == nullptr ? nullptr : newRedlandNode(world_, *term);
}

librdf_node* RedlandAnswer::value(const char* name) const {
  for (std::size_t column = 0; column < columns(); ++column) {
    if (std::strcmp(names_[column], name) == 0) return value(column);
  }
  return nullptr;
}

librdf_statement* RedlandAnswer::statement(std::size_t number) const {
  const Quad& quad = result_.graph[number];
  return librdf_new_statement_from_nodes(world_, newRedlandNode(world_, quad.subject),
                                         newRedlandNode(world_, quad.predicate), newRedlandNode(world_, quad.object));
}

librdf_stream* RedlandAnswer::stream() {
  auto* place = new StreamPlace{this};
  return librdf_new_stream(world_, place, streamIsEnd, streamNext, streamGet, streamFinished);
}

}  // namespace cluxel
