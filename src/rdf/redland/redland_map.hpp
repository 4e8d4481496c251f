// SPDX-License-Identifier: Apache-2.0
// A map opened by librdf's storage: changes, transactions and pattern matching.
#pragma once

#include <librdf.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

struct RedlandOptions {
  std::string file;
  bool create = false, write = true, strict = false;
};

/// The quads that match a pattern, without duplicates. Reads from its own snapshot, or from a copy when an open
/// transaction could change the quads before they are read.
class RedlandMatches {
 public:
  RedlandMatches(QuadReader reader, const QuadPattern& pattern, std::function<bool(QuadIds&)> accept, bool copy);
  bool atEnd() const { return at_end_; }
  void next();
  const QuadIds& quad() const { return quad_; }
  /// The term of an id that occurs in one of the quads.
  TermView viewOf(TermId id) const;

 private:
  bool take(QuadIds& quad);
  void copyAll();
  std::optional<QuadReader> reader_;  ///< absent for a copy, because it would keep the transaction open
  QuadCursor cursor_;
  std::function<bool(QuadIds&)> accept_;
  std::optional<std::vector<QuadIds>> copied_;
  std::unordered_map<TermId, Term> copied_terms_;
  std::size_t place_ = 0;
  QuadIds quad_;
  bool at_end_ = false;
};

class RedlandMap {
 public:
  RedlandMap(librdf_world* world, RedlandOptions options) : world_(world), options_(std::move(options)) {}

  librdf_world* world() const { return world_; }
  const RedlandOptions& options() const { return options_; }
  void open();
  void close();  ///< an open transaction is rolled back
  bool isOpen() const { return environment_ != nullptr; }
  const std::shared_ptr<Environment>& environment() const { return environment_; }

  /// The state that reads see: the open transaction with its changes, or the latest commit.
  ReadTransaction read();
  bool inTransaction() const { return transaction_.has_value(); }
  void begin(void* handle);
  void commit();
  void rollBack();
  void* handle() const { return handle_; }

  /// Runs changes in the open transaction, or in one of their own that is committed at once.
  void change(const std::function<void(QuadWriter&)>& changes);

  /// Matches in the union of all graphs but history, without duplicates; in a strict storage, in the unnamed graph.
  std::unique_ptr<RedlandMatches> find(const Term* s, const Term* p, const Term* o);
  std::unique_ptr<RedlandMatches> findIn(const Term& graph, const Term* s, const Term* p, const Term* o);
  /// All quads of all graphs; in a strict storage those of the unnamed graph.
  std::unique_ptr<RedlandMatches> all();
  /// Removes the triple from all graphs that find() reads. Throws Error (InvalidArgument), and removes nothing, when it
  /// lies in a graph that a build writes.
  void remove(const Term& s, const Term& p, const Term& o);
  void removeFrom(const Quad& quad);      ///< throws as above
  void removeContext(const Term& graph);  ///< throws as above, also for an empty graph

 private:
  std::unique_ptr<RedlandMatches> match(const Term* s, const Term* p, const Term* o, const Term* graph, bool whole);

  librdf_world* world_;
  RedlandOptions options_;
  std::shared_ptr<Environment> environment_;
  std::optional<WriteTransaction> transaction_;
  std::unique_ptr<QuadWriter> writer_;
  void* handle_ = nullptr;
};

}  // namespace cluxel::rdf
