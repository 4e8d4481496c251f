// SPDX-License-Identifier: Apache-2.0
// Finding the mapped pages of a commit through LMDB's interface, and the directories over them.
#include "knowledge/store_snapshot.hpp"

#include <unistd.h>

#include <algorithm>
#include <string>

#include "cluxel/base/diagnostic.hpp"

namespace cluxel {

namespace {

using namespace lmdb_page;

constexpr int kMaxDepth = 32;
constexpr std::uint64_t kNoMoreIds = 0xFFFFFFFF;

[[noreturn]] void damaged() {
  throw Error(ExitCode::StoreUnavailable,
              "the map is damaged: its dictionary points outside the file; `cluxel doctor` tells where");
}

std::uint64_t entriesOf(const ReadTransaction::Impl& transaction, Table table) {
  MDB_stat stat;
  transaction.check(mdb_stat(transaction.live(), transaction.table(table), &stat), "read the map");
  return stat.ms_entries;
}

/// Every page knows its own number, so the address of one gives that of the first.
PageMap mapAround(const void* inside, const ReadTransaction::Impl& transaction) {
  MDB_envinfo info;
  MDB_stat stat;
  if (mdb_env_info(transaction.environment->handle(), &info) != 0 ||
      mdb_env_stat(transaction.environment->handle(), &stat) != 0)
    return {};
  const std::uintptr_t page_size = stat.ms_psize;
  // The map begins at a page of the system, which may be smaller than a page of a map from another machine.
  if (page_size > static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE))) return {};
  const auto* page =
      static_cast<const std::uint8_t*>(inside) - reinterpret_cast<std::uintptr_t>(inside) % page_size;
  const PageNumber number = header(page).number;
  if (number > info.me_last_pgno) return {};
  const std::uint8_t* base = page - number * page_size;
  if (load<Meta>(base + kHeaderSize).magic != kMagic) return {};
  return {base, page_size, info.me_last_pgno + 1};
}

}  // namespace

TermDirectory::TermDirectory(const PageMap& map, const Tree& table) : map_(map) {
  if (table.leaf_pages > map.page_count) damaged();
  first_.reserve(table.leaf_pages);
  pages_.reserve(table.leaf_pages);
  if (table.root != kNoPage) collect(table.root, 1, 0);
  if (table.entries >= kNoMoreIds) damaged();
  first_.push_back(static_cast<TermId>(table.entries) + 1);
  indexIds();
}

void TermDirectory::indexIds() {
  const TermId end = first_.back();
  page_of_.reserve((end >> kStrideBits) + 1);
  std::uint32_t page = 0;
  for (std::uint64_t id = 0; id < end; id += std::uint64_t{1} << kStrideBits) {
    while (page + 1 < pages_.size() && first_[page + 1] <= id) ++page;
    page_of_.push_back(page);
  }
}

void TermDirectory::collect(PageNumber number, TermId first, int depth) {
  const std::uint8_t* page = map_.page(number);
  if (depth > kMaxDepth) damaged();
  if ((header(page).flags & kLeaf) != 0) {
    first_.push_back(first);
    pages_.push_back(page);
    return;
  }
  const std::size_t count = std::min<std::size_t>(lmdb_page::entryCount(page), map_.page_size / 2);
  bool leaves = false;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = load<std::uint16_t>(page + kHeaderSize + 2 * i);
    if (at + 8 + sizeof(TermId) > map_.page_size && (i > 0 || at + 8 > map_.page_size)) damaged();
    const Node node(page + at);
    const TermId child_first = i == 0 || node.keySize() != sizeof(TermId) ? first : load<TermId>(node.key());
    const std::uint8_t* child = map_.page(node.child());
    if (i == 0) leaves = (header(child).flags & kLeaf) != 0;
    if (leaves) {
      first_.push_back(child_first);
      pages_.push_back(child);
    } else {
      collect(node.child(), child_first, depth + 1);
    }
  }
}

std::string_view TermDirectory::record(TermId id) const {
  if (id == kNoTerm || id >= first_.back() || pages_.empty()) return {};
  std::size_t number = page_of_[id >> kStrideBits];
  while (number + 1 < pages_.size() && first_[number + 1] <= id) ++number;
  const std::uint8_t* page = pages_[number];
  const std::size_t i = id - first_[number];
  if (i >= lmdb_page::entryCount(page)) return {};
  const std::size_t at = load<std::uint16_t>(page + kHeaderSize + 2 * i);
  if (at + 8 + sizeof(TermId) > map_.page_size) damaged();
  const Node node(page + at);
  if (node.keySize() != sizeof(TermId) || load<TermId>(node.key()) != id) damaged();
  const std::uint8_t* data = node.data();
  const std::size_t size = node.dataSize();
  if ((node.flags() & kBigData) != 0) {
    const PageNumber first_page = load<PageNumber>(data);
    map_.page(first_page + (kHeaderSize + size - 1) / map_.page_size);
    data = map_.page(first_page) + kHeaderSize;
  } else if (data + size > page + map_.page_size) {
    damaged();
  }
  return {reinterpret_cast<const char*>(data), size};
}

StoreSnapshot::StoreSnapshot(const ReadTransaction::Impl& transaction)
    : size_(entriesOf(transaction, Table::Spog)), term_count_(entriesOf(transaction, Table::Terms)) {
  if (transaction.writing) return;
  MDB_dbi main = 0;
  transaction.check(mdb_dbi_open(transaction.live(), nullptr, 0, &main), "read the map");
  for (std::size_t i = 0; i < kTableCount; ++i) {
    MDB_val key = toVal(kTableNames[i]);
    MDB_val record;
    transaction.check(mdb_get(transaction.live(), main, &key, &record), "read the map");
    if (record.mv_size != sizeof(Tree)) damaged();
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

std::string_view StoreSnapshot::record(TermId id, const ReadTransaction::Impl& transaction) {
  std::string_view bytes;
  if (map_.base != nullptr) {
    std::call_once(terms_made_, [&] {
      terms_ = std::make_unique<TermDirectory>(map_, trees_[static_cast<std::size_t>(Table::Terms)]);
    });
    bytes = terms_->record(id);
  } else {
    MDB_val key{sizeof id, &id};
    MDB_val data{0, nullptr};
    const int code = mdb_get(transaction.live(), transaction.table(Table::Terms), &key, &data);
    if (code != MDB_NOTFOUND) transaction.check(code, "read a term");
    if (code == MDB_SUCCESS) bytes = toView(data);
  }
  if (bytes.empty())
    throw Error(ExitCode::StoreUnavailable, transaction.environment->file().string() +
                                                ": the map is damaged: there is no term " +
                                                std::to_string(id));
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
  if (transaction.snapshot && transaction.snapshot_generation == transaction.generation)
    return *transaction.snapshot;
  const auto make = [&] { return std::make_shared<StoreSnapshot>(transaction); };
  transaction.snapshot =
      transaction.writing ? make() : transaction.environment->snapshot(mdb_txn_id(transaction.live()), make);
  transaction.snapshot_generation = transaction.generation;
  return *transaction.snapshot;
}

}  // namespace cluxel
