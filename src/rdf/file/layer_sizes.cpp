// SPDX-License-Identifier: Apache-2.0
// Counts pages as LMDB's data format 1 lays entries out.
#include "rdf/file/layer_sizes.hpp"

#include <algorithm>
#include <cstring>
#include <map>

#include "rdf/file/lmdb_environment.hpp"
#include "rdf/store/store_snapshot.hpp"

namespace cluxel::rdf {

namespace {

constexpr MDB_dbi kFreePages = 0;  // LMDB's own table of free pages
constexpr const char* kFreePagesName = "free pages";
constexpr std::uint64_t kNodeHead = 8, kNodeSlot = 2;

/// Calls `visit` with each entry of a table, without reading long values.
template <typename Visit>
void forEachEntry(const ReadTransaction::Impl& state, MDB_dbi table, const Visit& visit) {
  MDB_cursor* raw = nullptr;
  state.check(mdb_cursor_open(state.live(), table, &raw), "read a table");
  const CursorHandle cursor(raw);
  MDB_val key;
  MDB_val value;
  int code = mdb_cursor_get(raw, &key, &value, MDB_FIRST);
  for (; code == MDB_SUCCESS; code = mdb_cursor_get(raw, &key, &value, MDB_NEXT)) visit(toView(key), toView(value));
  if (code != MDB_NOTFOUND) state.check(code, "read a table");
}

/// A leaf holds at least two nodes; the value of a longer one has pages of its own.
std::uint64_t bytesOfEntry(std::uint64_t key, std::uint64_t value, std::uint64_t page) {
  const std::uint64_t longest = (((page - lmdb_page::kHeaderSize) / 2) & ~std::uint64_t{1}) - kNodeSlot;
  const std::uint64_t node = kNodeHead + key + value;
  if (node <= longest) return node + (node & 1U) + kNodeSlot;
  const std::uint64_t pages = (lmdb_page::kHeaderSize - 1 + value) / page + 1;
  return kNodeHead + key + sizeof(lmdb_page::PageNumber) + kNodeSlot + pages * page;
}

std::uint64_t freePages(const ReadTransaction::Impl& state) {
  std::uint64_t free = 0;
  forEachEntry(state, kFreePages, [&](std::string_view, std::string_view value) {
    std::size_t count = 0;
    if (value.size() >= sizeof count) std::memcpy(&count, value.data(), sizeof count);
    free += std::min(count, value.size() / sizeof count);
  });
  return free;
}

/// The part of the file that the commit knows.
std::uint64_t fileBytes(const ReadTransaction::Impl& state, std::uint64_t page) {
  MDB_envinfo info;
  state.check(mdb_env_info(state.environment->handle(), &info), "read the map");
  return std::min<std::uint64_t>(state.environment->fileSize(), (info.me_last_pgno + 1) * page);
}

class LayerCount {
 public:
  explicit LayerCount(const ReadTransaction& transaction) : state_(transaction.impl()) {
    MDB_stat stat;
    state_.check(mdb_stat(state_.live(), state_.environment->mainTable(), &stat), "read the map");
    page_ = stat.ms_psize;
  }

  std::vector<LayerSize> run() {
    addBlocks();
    addTerms();
    for (const Table index : state_.environment->indexes()) addIndex(index);
    addPages();
    return std::move(layers_);
  }

 private:
  void addBlocks() {
    std::map<std::string, LayerSize, std::less<>> by_table;
    forEachEntry(state_, state_.table(Table::Blocks), [&](std::string_view key, std::string_view value) {
      const std::string_view name = key.substr(0, key.find('\0'));
      auto found = by_table.find(name);
      if (found == by_table.end()) found = by_table.emplace(name, LayerSize{std::string(name)}).first;
      ++found->second.entries;
      found->second.file_bytes += bytesOfEntry(key.size(), value.size(), page_);
    });
    for (auto& [name, layer] : by_table) layers_.push_back(std::move(layer));
  }

  void addTerms() {
    LayerSize terms{"terms"};
    forEachEntry(state_, state_.table(Table::Terms), [&](std::string_view key, std::string_view value) {
      ++terms.entries;
      terms.file_bytes += bytesOfEntry(key.size(), value.size(), page_);
    });
    layers_.push_back(std::move(terms));
  }

  void addIndex(Table table) {
    const PageDirectory& directory = snapshotOf(state_).directory(table, state_);
    const std::uint64_t pages = directory.pageCount();
    layers_.push_back({kTableNames[static_cast<std::size_t>(table)],
                       directory.distance(directory.begin(), directory.end()), pages > 1 ? pages * page_ : 0});
  }

  void addPages() {
    const std::uint64_t free = freePages(state_), all = fileBytes(state_, page_);
    std::uint64_t known = free * page_;
    for (const LayerSize& layer : layers_) known += layer.file_bytes;
    const std::uint64_t other = all - std::min(all, known);
    layers_.push_back({"other pages", other / page_, other});
    layers_.push_back({kFreePagesName, free, free * page_});
  }

  ReadTransaction::Impl& state_;
  std::uint64_t page_ = 0;
  std::vector<LayerSize> layers_;
};

}  // namespace

FreeSpace freeSpaceOf(const ReadTransaction& transaction) {
  ReadTransaction::Impl& state = transaction.impl();
  MDB_stat stat;
  state.check(mdb_stat(state.live(), state.environment->mainTable(), &stat), "read the map");
  const std::uint64_t page = stat.ms_psize;
  const std::uint64_t in_free_pages = freePages(state) * page;
  FreeSpace space{in_free_pages, fileBytes(state, page), in_free_pages};
  StoreSnapshot& snapshot = snapshotOf(state);
  if (!snapshot.isMapped()) return space;  // then the pages of indexes are not known without reading them
  for (const Table index : state.environment->indexes()) {
    state.check(mdb_stat(state.live(), state.table(index), &stat), "read the map");
    const std::uint64_t used = snapshot.leafPages(index) * page, needed = stat.ms_entries * sizeof(QuadKey);
    space.bytes += used - std::min(used, needed);
  }
  return space;
}

std::vector<LayerSize> layerSizes(const ReadTransaction& transaction) {
  const ReadTransaction::Impl& state = transaction.impl();
  state.environment->checkPages(state);  // LMDB trusts what it walks, and no query reads these pages
  return LayerCount(transaction).run();
}

}  // namespace cluxel::rdf
