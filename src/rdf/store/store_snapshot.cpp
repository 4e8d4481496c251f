// SPDX-License-Identifier: Apache-2.0
// Locates the mapped pages of a commit through LMDB's API and builds the directories over them.
#include "rdf/store/store_snapshot.hpp"

#include <unistd.h>

#include <algorithm>
#include <string>

#include "cluxel/error.hpp"
#include "rdf/file/check/map_file_head.hpp"
#include "rdf/store/indexes/index_directories.hpp"
#include "rdf/store/indexes/index_draft.hpp"
#include "rdf/terms/term_record.hpp"

namespace cluxel::rdf {

namespace {

using namespace lmdb_page;

std::uint64_t entriesOf(const ReadTransaction::Impl& transaction, Table table) {
  if (const IndexDraft* draft = transaction.draftOf(table)) return draft->size();
  MDB_stat stat;
  transaction.check(mdb_stat(transaction.live(), transaction.table(table), &stat), "read the map");
  return stat.ms_entries;
}

/// Maps of earlier formats have no index psog.
bool isMissing(Table table, const ReadTransaction::Impl& transaction) {
  return table == Table::Psog && !transaction.environment->keepsNumbersApart();
}

/// Every page stores its own number, so the address of one page gives the base of the mapping.
PageMap mapAround(const void* inside, const ReadTransaction::Impl& transaction) {
  MDB_envinfo info;
  MDB_stat stat;
  if (mdb_env_info(transaction.environment->handle(), &info) != 0 ||
      mdb_env_stat(transaction.environment->handle(), &stat) != 0)
    return {};
  const std::uintptr_t page_size = stat.ms_psize;
  // The mapping is aligned to the system's page size, which may be smaller than the page size of a map from another
  // machine.
  if (page_size > static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE))) return {};
  const auto* page = static_cast<const std::uint8_t*>(inside) - reinterpret_cast<std::uintptr_t>(inside) % page_size;
  const PageNumber number = header(page).number;
  if (number > info.me_last_pgno) return {};
  const std::uint8_t* base = page - number * page_size;
  if (load<Meta>(base + kHeaderSize).magic != kMagic) return {};
  // The file may be shorter than its head states: free pages at its end are not written, and a file may be cut short.
  return {base, page_size, std::min(info.me_last_pgno + 1, transaction.environment->fileSize() / page_size)};
}

}  // namespace

StoreSnapshot::StoreSnapshot(const ReadTransaction::Impl& transaction)
    : size_(entriesOf(transaction, Table::Spog)), term_count_(entriesOf(transaction, Table::Terms)) {
  if (transaction.writing) {
    const std::shared_ptr<StoreSnapshot>& before = transaction.directories->committed();
    if (before && before->by_parts_) base_ = before;
    return;
  }
  MDB_dbi main = 0;
  transaction.check(mdb_dbi_open(transaction.live(), nullptr, 0, &main), "read the map");
  for (std::size_t i = 0; i < kTableCount; ++i) {
    MDB_val key = toVal(kTableNames[i]);
    MDB_val record;
    const int code = mdb_get(transaction.live(), main, &key, &record);
    if (code == MDB_NOTFOUND && isMissing(static_cast<Table>(i), transaction)) {
      trees_[i].root = kNoPage;
      continue;
    }
    transaction.check(code, "read the map");
    if (record.mv_size != sizeof(Tree)) failOutside("its dictionary");
    trees_[i] = load<Tree>(static_cast<const std::uint8_t*>(record.mv_data));
    if (i == 0) map_ = mapAround(record.mv_data, transaction);
  }
  const std::size_t commit = mdb_txn_id(transaction.live());
  by_parts_ = map_.base != nullptr && transaction.environment->isComparedByParts();
  checked_ = transaction.environment->checkedPartsOf(commit);
  if (by_parts_ || !transaction.environment->wrote(commit)) sums_ = storedSums(transaction, commit);
  if (sums_) requireCounts(transaction.environment->file());
}

void StoreSnapshot::requireCounts(const std::filesystem::path& file) const {
  for (std::size_t i = static_cast<std::size_t>(Table::Terms); i < kTableCount; ++i) {
    if (trees_[i].entries != sums_->of(static_cast<Table>(i)).count)
      refuseDamaged(file, std::string("table ") + kTableNames[i] + " has another number of entries than was written");
  }
}

void StoreSnapshot::verifyIndex(Table index, const std::filesystem::path& file) const {
  const auto i = static_cast<std::size_t>(index);
  if (sums_ && sumOf(*directories_[i], index, file) != sums_->of(index))
    refuseIndex(file, index, "differs from its checksum");
}

void StoreSnapshot::verify(ReadTransaction::Impl& transaction) {
  for (const Table index : transaction.environment->indexes())
    if (const auto& guard = directory(index, transaction).guard()) guard->checkAll();
  for (std::uint64_t id = 1; id <= term_count_; id = (id / kTermsOfSum + 1) * kTermsOfSum)
    record(static_cast<TermId>(id), transaction);
}

std::shared_ptr<const PageDirectory> StoreSnapshot::sharedDirectory(Table index, ReadTransaction::Impl& transaction) {
  const auto i = static_cast<std::size_t>(index);
  std::call_once(made_[i], [&] {
    if (map_.base == nullptr) {
      directories_[i] = transaction.directories->of(index, transaction);
    } else {
      PageDirectory pages(map_, trees_[i]);
      if (by_parts_ && pages.pageCount() > 1) {
        directories_[i] = guarded(std::move(pages), index, transaction);
        return;
      }
      directories_[i] = std::make_shared<const PageDirectory>(std::move(pages));
    }
    verifyIndex(index, transaction.environment->file());
  });
  return directories_[i];
}

std::shared_ptr<const PageDirectory> StoreSnapshot::guarded(PageDirectory pages, Table index,
                                                            ReadTransaction::Impl& transaction) {
  const std::filesystem::path& file = transaction.environment->file();
  RangeSums ranges = storedRanges(transaction, index);
  if (ranges.whole() != sums_->of(index))
    refuseDamaged(file, std::string("the sums of index ") + kTableNames[static_cast<std::size_t>(index)] +
                            " differ from the sum of the whole");
  const auto guard = std::make_shared<PageGuard>(map_, std::move(pages), std::move(ranges), index, file);
  const std::scoped_lock lock(checked_->mutex);
  std::shared_ptr<const PageGuard>& last = checked_->guards[static_cast<std::size_t>(index)];
  if (last) guard->inherit(*last);
  last = guard;
  return std::make_shared<const PageDirectory>(guard->pages(), guard);
}

void StoreSnapshot::prepareForWriting(ReadTransaction::Impl& transaction) {
  if (by_parts_) requireSums(transaction);
}

const TermDirectory& StoreSnapshot::terms() {
  std::call_once(terms_made_, [&] {
    terms_ = std::make_unique<TermDirectory>(map_, trees_[static_cast<std::size_t>(Table::Terms)]);
  });
  return *terms_;
}

std::string_view StoreSnapshot::storedRecord(TermId id, const ReadTransaction::Impl& transaction) {
  std::string_view bytes;
  if (map_.base != nullptr) {
    bytes = terms().record(id);
  } else {
    MDB_val key{sizeof id, &id};
    MDB_val data{0, nullptr};
    const int code = mdb_get(transaction.live(), transaction.table(Table::Terms), &key, &data);
    if (code != MDB_NOTFOUND) transaction.check(code, "read a term");
    if (code == MDB_SUCCESS) bytes = toView(data);
  }
  if (bytes.empty()) refuseDamaged(transaction.environment->file(), "there is no term " + std::to_string(id));
  return bytes;
}

std::string_view StoreSnapshot::record(TermId id, ReadTransaction::Impl& transaction) {
  if (base_ && id <= base_->term_count_) {
    base_->requireTerm(id, transaction);
    return base_->storedRecord(id, transaction);  // in place, which is faster than LMDB's search
  }
  if (sums_ && id <= term_count_) requireTerm(id, transaction);
  return storedRecord(id, transaction);
}

std::optional<TermId> StoreSnapshot::idOf(const TermHash& hash, std::string_view bytes,
                                          ReadTransaction::Impl& transaction) {
  if (term_count_ == 0) return std::nullopt;
  const PageDirectory& hashes = directory(Table::TermHashes, transaction);
  const Key128 first = keyOfTerm(hash, kNoTerm);
  auto position = hashes.lowerBound(first);
  for (; position.page < hashes.pageCount(); ++position.index) {
    if (position.index == hashes.page(position.page).size()) position = {position.page + 1, 0};
    if (position.page == hashes.pageCount()) break;
    const QuadKey& key = hashes.page(position.page)[position.index];
    if ((toNumber(key) >> 32U) != (first >> 32U)) break;
    if (record(key.at(3), transaction) == bytes) return key.at(3);
  }
  return std::nullopt;
}

void StoreSnapshot::requireTerm(TermId id, ReadTransaction::Impl& transaction) {
  requireSums(transaction);
  const TermId number = id / kTermsOfSum;
  // Beyond the end are terms that this process wrote.
  if (number < verified_terms_->size() && !(*verified_terms_)[number].load(std::memory_order_relaxed))
    verifyTerms(number, transaction);
}

void StoreSnapshot::requireSums(ReadTransaction::Impl& transaction) {
  std::call_once(term_sums_read_, [&] {
    term_sums_ = storedTermSums(transaction, term_count_);
    const std::scoped_lock lock(checked_->mutex);
    if (!checked_->verified_terms)
      checked_->verified_terms = std::make_shared<std::vector<std::atomic<bool>>>(term_sums_.size());
    verified_terms_ = checked_->verified_terms;
  });
}

void StoreSnapshot::verifyTerms(TermId number, const ReadTransaction::Impl& transaction) {
  const std::uint64_t first = std::uint64_t{number} * kTermsOfSum;
  const std::uint64_t last = std::min(first + kTermsOfSum - 1, term_count_);
  std::uint64_t sum = 0;
  for (std::uint64_t id = std::max<std::uint64_t>(1, first); id <= last; ++id) {
    const auto term = static_cast<TermId>(id);
    sum += hashOfKey(keyOfTerm(hashOfRecord(storedRecord(term, transaction)), term));
  }
  if (sum != term_sums_[number])
    refuseDamaged(transaction.environment->file(), "the terms from " + std::to_string(first) + " to " +
                                                       std::to_string(last) + " differ from their checksum");
  (*verified_terms_)[number].store(true, std::memory_order_relaxed);
}

std::optional<QuadReader::PredicateStatistics> StoreSnapshot::knownStatistics(TermId predicate) {
  const std::lock_guard lock(statistics_mutex_);
  const auto found = statistics_.find(predicate);
  return found == statistics_.end() ? std::nullopt : std::optional(found->second);
}

void StoreSnapshot::keepStatistics(TermId predicate, const QuadReader::PredicateStatistics& statistics) {
  const std::lock_guard lock(statistics_mutex_);
  statistics_.emplace(predicate, statistics);
}

std::shared_ptr<const void> StoreSnapshot::kept(const std::string& name) {
  const std::scoped_lock lock(kept_mutex_);
  const auto found = kept_.find(name);
  return found == kept_.end() ? nullptr : found->second;
}

void StoreSnapshot::keep(const std::string& name, std::shared_ptr<const void> made) {
  const std::scoped_lock lock(kept_mutex_);
  kept_[name] = std::move(made);
}

const std::shared_ptr<StoreSnapshot>& sharedSnapshotOf(ReadTransaction::Impl& transaction) {
  if (transaction.snapshot && transaction.snapshot_generation == transaction.generation) return transaction.snapshot;
  transaction.requireSound();
  const auto make = [&] { return std::make_shared<StoreSnapshot>(transaction); };
  transaction.snapshot =
      transaction.writing ? make() : transaction.environment->snapshot(mdb_txn_id(transaction.live()), make);
  transaction.snapshot_generation = transaction.generation;
  return transaction.snapshot;
}

}  // namespace cluxel::rdf
