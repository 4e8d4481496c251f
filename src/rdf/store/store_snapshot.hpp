// SPDX-License-Identifier: Apache-2.0
// State shared by the readers of one commit: statistics and lazily built page directories.
#pragma once

#include <array>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "rdf/file/check/page_guard.hpp"
#include "rdf/file/lmdb_environment.hpp"
#include "rdf/file/page_directory.hpp"
#include "rdf/store/quad_store.hpp"
#include "rdf/terms/term_directory.hpp"

namespace cluxel::rdf {

/// What was compared of a commit with its sums. Own commits share it, as what this process writes need not be compared.
struct CheckedParts {
  std::mutex mutex;
  std::array<std::shared_ptr<const PageGuard>, kTableCount> guards;  ///< the last ones
  std::shared_ptr<std::vector<std::atomic<bool>>> verified_terms;    ///< of each 64 terms; none: none is verified
};

class StoreSnapshot : public std::enable_shared_from_this<StoreSnapshot> {
 public:
  /// For the commit, or the current state of the write transaction, that `transaction` sees.
  explicit StoreSnapshot(const ReadTransaction::Impl& transaction);

  std::uint64_t size() const { return size_; }
  std::uint64_t termCount() const { return term_count_; }
  /// The directory of an index; `transaction` must see the same state as this snapshot, or have begun with it. Its
  /// pages are compared with their sums when they are first read, unless this process compared them in an earlier
  /// commit; those of maps without sums of ranges and of small indexes by the first call. Thread-safe.
  std::shared_ptr<const PageDirectory> sharedDirectory(Table index, ReadTransaction::Impl& transaction);
  const PageDirectory& directory(Table index, ReadTransaction::Impl& transaction) {
    return *sharedDirectory(index, transaction);
  }
  /// The pages of an index, without a look at them. Only for committed states.
  std::uint64_t leafPages(Table index) const { return leafPagesOf(map_, trees_[static_cast<std::size_t>(index)]); }
  bool isMapped() const { return map_.base != nullptr; }
  const PageMap& map() const { return map_; }
  /// The record of a term; throws Error for an unknown id. Of each 64 terms the first one that is read compares all
  /// with their sum. Thread-safe.
  std::string_view record(TermId id, ReadTransaction::Impl& transaction);
  /// The term with this record; `hash` is that of the record.
  std::optional<TermId> idOf(const TermHash& hash, std::string_view record, ReadTransaction::Impl& transaction);
  /// Compares all indexes and terms with their sums.
  void verify(ReadTransaction::Impl& transaction);
  /// Reads what readers of a write transaction need that begins with this commit, which `transaction` sees.
  void prepareForWriting(ReadTransaction::Impl& transaction);
  /// Whether pages and terms are compared when they are first read.
  bool isComparedByParts() const { return by_parts_; }
  const std::shared_ptr<CheckedParts>& checkedParts() const { return checked_; }

  /// Where estimates are kept that were made without comparison: with the commit before a write transaction.
  StoreSnapshot& keeperOfEstimates() { return base_ ? *base_ : *this; }
  std::optional<QuadReader::PredicateStatistics> knownStatistics(TermId predicate);
  void keepStatistics(TermId predicate, const QuadReader::PredicateStatistics& statistics);
  std::shared_ptr<const void> kept(const std::string& name);
  void keep(const std::string& name, std::shared_ptr<const void> made);

 private:
  void requireCounts(const std::filesystem::path& file) const;
  void verifyIndex(Table index, const std::filesystem::path& file) const;
  std::shared_ptr<const PageDirectory> guarded(PageDirectory pages, Table index, ReadTransaction::Impl& transaction);
  void requireTerm(TermId id, ReadTransaction::Impl& transaction);
  std::string_view storedRecord(TermId id, const ReadTransaction::Impl& transaction);
  void requireSums(ReadTransaction::Impl& transaction);
  void verifyTerms(TermId number, const ReadTransaction::Impl& transaction);

  std::uint64_t size_ = 0, term_count_ = 0;
  std::optional<StoreSums> sums_;  ///< none where nothing is compared: write transactions, format 1, own commits
                                   ///< without sums of ranges
  bool by_parts_ = false;
  std::shared_ptr<CheckedParts> checked_;
  std::shared_ptr<StoreSnapshot> base_;  ///< of a write transaction: the commit before, when it is compared by parts
  PageMap map_;                          ///< without a base address, pages are read through cursors
  std::array<lmdb_page::Tree, kTableCount> trees_{};
  std::array<std::once_flag, kTableCount> made_;
  std::array<std::shared_ptr<const PageDirectory>, kTableCount> directories_;
  const TermDirectory& terms();
  std::once_flag terms_made_, term_sums_read_;
  std::unique_ptr<TermDirectory> terms_;
  std::vector<std::uint64_t> term_sums_;
  std::shared_ptr<std::vector<std::atomic<bool>>> verified_terms_;
  std::mutex statistics_mutex_;
  std::map<TermId, QuadReader::PredicateStatistics> statistics_;
  std::mutex kept_mutex_;
  std::map<std::string, std::shared_ptr<const void>> kept_;
};

/// The snapshot of a transaction: shared among the readers of a commit, rebuilt after changes in a write transaction.
const std::shared_ptr<StoreSnapshot>& sharedSnapshotOf(ReadTransaction::Impl& transaction);
inline StoreSnapshot& snapshotOf(ReadTransaction::Impl& transaction) {
  return *sharedSnapshotOf(transaction);
}

}  // namespace cluxel::rdf
