// SPDX-License-Identifier: Apache-2.0
// What one commit's readers share: page directories, made when first wanted, and statistics.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "cluxel/knowledge/quad_store.hpp"
#include "knowledge/lmdb_environment.hpp"
#include "knowledge/page_directory.hpp"
#include "knowledge/term_directory.hpp"

namespace cluxel {

class StoreSnapshot {
 public:
  /// Of the commit, or the present state of the write transaction, that `transaction` sees.
  explicit StoreSnapshot(const ReadTransaction::Impl& transaction);

  std::uint64_t size() const { return size_; }
  std::uint64_t termCount() const { return term_count_; }
  /// The directory of an index; `transaction` is one that sees what this snapshot is of. Thread-safe.
  const PageDirectory& directory(Table index, const ReadTransaction::Impl& transaction);
  /// The bytes of a term; an Error when there is no such id. Thread-safe.
  std::string_view record(TermId id, const ReadTransaction::Impl& transaction);
  /// Asks the memory for the records of terms that are wanted soon. Thread-safe.
  void expectRecords(std::span<const TermId> ids);

  std::optional<QuadReader::PredicateStatistics> knownStatistics(TermId predicate);
  void keepStatistics(TermId predicate, const QuadReader::PredicateStatistics& statistics);
  std::shared_ptr<const void> kept(const std::string& name);
  void keep(const std::string& name, std::shared_ptr<const void> made);

 private:
  std::uint64_t size_ = 0, term_count_ = 0;
  PageMap map_;  ///< without a base: pages are reached through cursors
  std::array<lmdb_page::Tree, kTableCount> trees_{};
  std::array<std::once_flag, kTableCount> made_;
  std::array<PageDirectory, kTableCount> directories_;
  const TermDirectory& terms();
  std::once_flag terms_made_;
  std::unique_ptr<TermDirectory> terms_;
  std::mutex statistics_mutex_;
  std::map<TermId, QuadReader::PredicateStatistics> statistics_;
  std::mutex kept_mutex_;
  std::map<std::string, std::shared_ptr<const void>> kept_;
};

/// The snapshot of a transaction: shared among the readers of one commit, remade when a write transaction has
/// changed.
StoreSnapshot& snapshotOf(ReadTransaction::Impl& transaction);

}  // namespace cluxel
