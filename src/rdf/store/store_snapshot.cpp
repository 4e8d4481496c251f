// SPDX-License-Identifier: Apache-2.0
// Locates the mapped pages of a commit through LMDB's API and builds the directories over them.
#include "rdf/store/store_snapshot.hpp"

#include <unistd.h>

#include <algorithm>
#include <string>

#include "cluxel/error.hpp"

namespace cluxel::rdf {

namespace {

using namespace lmdb_page;

std::uint64_t entriesOf(const ReadTransaction::Impl& transaction, Table table) {
  MDB_stat stat;
  transaction.check(mdb_stat(transaction.live(), transaction.table(table), &stat), "read the map");
  return stat.ms_entries;
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
  return {base, page_size, info.me_last_pgno + 1};
}

}  // namespace

StoreSnapshot::StoreSnapshot(const ReadTransaction::Impl& transaction)
    : size_(entriesOf(transaction, Table::Spog)), term_count_(entriesOf(transaction, Table::Terms)) {
  if (transaction.writing) return;
  MDB_dbi main = 0;
  transaction.check(mdb_dbi_open(transaction.live(), nullptr, 0, &main), "read the map");
  for (std::size_t i = 0; i < kTableCount; ++i) {
    MDB_val key = toVal(kTableNames[i]);
    MDB_val record;
    transaction.check(mdb_get(transaction.live(), main, &key, &record), "read the map");
    if (record.mv_size != sizeof(Tree)) failOutside("its dictionary");
    trees_[i] = load<Tree>(static_cast<const std::uint8_t*>(record.mv_data));
    if (i == 0) map_ = mapAround(record.mv_data, transaction);
  }
}

const PageDirectory& StoreSnapshot::directory(Table index, const ReadTransaction::Impl& transaction) {
  const auto i = static_cast<std::size_t>(index);
  std::call_once(made_[i], [&] {
    if (map_.base != nullptr) {
      directories_[i] = PageDirectory(map_, trees_[i]);
      return;
    }
    MDB_cursor* raw = nullptr;
    transaction.check(mdb_cursor_open(transaction.live(), transaction.table(index), &raw), "read an index");
    const CursorHandle cursor(raw);
    directories_[i] = PageDirectory(raw);
  });
  return directories_[i];
}

const TermDirectory& StoreSnapshot::terms() {
  std::call_once(terms_made_, [&] {
    terms_ = std::make_unique<TermDirectory>(map_, trees_[static_cast<std::size_t>(Table::Terms)]);
  });
  return *terms_;
}

void StoreSnapshot::expectRecords(std::span<const TermId> ids) {
  if (map_.base != nullptr) terms().expect(ids);
}

std::string_view StoreSnapshot::record(TermId id, const ReadTransaction::Impl& transaction) {
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
  if (bytes.empty())
    throw Error(ErrorKind::StoreUnavailable, transaction.environment->file().string() +
                                                 ": the map is damaged: there is no term " + std::to_string(id));
  return bytes;
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

StoreSnapshot& snapshotOf(ReadTransaction::Impl& transaction) {
  if (transaction.snapshot && transaction.snapshot_generation == transaction.generation) return *transaction.snapshot;
  const auto make = [&] { return std::make_shared<StoreSnapshot>(transaction); };
  transaction.snapshot =
      transaction.writing ? make() : transaction.environment->snapshot(mdb_txn_id(transaction.live()), make);
  transaction.snapshot_generation = transaction.generation;
  return *transaction.snapshot;
}

}  // namespace cluxel::rdf
