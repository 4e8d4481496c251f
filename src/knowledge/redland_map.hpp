// SPDX-License-Identifier: Apache-2.0
// An opened map as librdf's storage sees it: changes, transactions, matches.
#pragma once

#include <librdf.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "cluxel/knowledge/quad_store.hpp"

namespace cluxel {

struct RedlandOptions {
  std::string file;
  bool create = false, write = true, strict = false;
};

/// Quads that match a pattern, each given once; a snapshot of its own, or a list with its terms when a transaction may
/// change them or end before they are read.
class RedlandMatches {
 public:
  RedlandMatches(QuadReader reader, const QuadPattern& pattern, std::function<bool(QuadIds&)> accept, bool copy);
  bool atEnd() const { return at_end_; }
  void next();
  const QuadIds& quad() const { return quad_; }
  /// The term of an id in one of the quads.
  TermView viewOf(TermId id) const;

 private:
  bool take(QuadIds& quad);
  void copyAll();
  std::optional<QuadReader> reader_;  ///< none behind a copy: it would keep the transaction
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

  /// What reads see: the transaction with all it has changed, or the latest commit.
  ReadTransaction read();
  bool inTransaction() const { return transaction_.has_value(); }
  void begin(void* handle);
  void commit();
  void rollBack();
  void* handle() const { return handle_; }

  /// Runs changes in the open transaction, or as a commit of their own.
  void change(const std::function<void(QuadWriter&)>& changes);

  /// The union of all graphs but history, each triple once; in a strict storage the unnamed graph.
  std::unique_ptr<RedlandMatches> find(const Term* s, const Term* p, const Term* o);
  std::unique_ptr<RedlandMatches> findIn(const Term& graph, const Term* s, const Term* p, const Term* o);
  /// All quads of all graphs; in a strict storage those of the unnamed graph.
  std::unique_ptr<RedlandMatches> all();
  /// Removes the triple from all graphs that find() looks into.
  void remove(const Term& s, const Term& p, const Term& o);

 private:
  std::unique_ptr<RedlandMatches> match(const Term* s, const Term* p, const Term* o, const Term* graph, bool whole);

  librdf_world* world_;
  RedlandOptions options_;
  std::shared_ptr<Environment> environment_;
  std::optional<WriteTransaction> transaction_;
  std::unique_ptr<QuadWriter> writer_;
  void* handle_ = nullptr;
};

}  // namespace cluxel
