// SPDX-License-Identifier: Apache-2.0
// An answer as librdf's users walk through it.
#pragma once

#include <librdf.h>

#include <string>
#include <vector>

#include "cluxel/sparql/result_table.hpp"

namespace cluxel {

class RedlandAnswer {
 public:
  RedlandAnswer(librdf_world* world, QueryResult result);

  const QueryResult& result() const { return result_; }
  librdf_world* world() const { return world_; }
  bool finished() const { return row_ >= result_.table.row_count; }
  void next() { ++row_; }
  std::size_t count() const { return finished() ? row_ : row_ + 1; }
  std::size_t columns() const { return names_.size() - 1; }
  /// Null-ended.
  const char** names() { return names_.data(); }
  /// A new node; null when unbound or out of range.
  librdf_node* value(std::size_t column) const;
  librdf_node* value(const char* name) const;
  /// A new statement of a graph answer.
  librdf_statement* statement(std::size_t number) const;
  librdf_stream* stream();

 private:
  librdf_world* world_;
  QueryResult result_;
  std::vector<const char*> names_;
  std::size_t row_ = 0;
};

/// A new node for a term.
librdf_node* newRedlandNode(librdf_world* world, const Term& term);
/// The term of a node.
Term redlandTerm(librdf_node* node);

}  // namespace cluxel
