// SPDX-License-Identifier: Apache-2.0
// Counts pages as LMDB's data format 1 lays entries out.
#include "rdf/file/space/layer_sizes.hpp"

#include <algorithm>
#include <map>

#include "rdf/file/lmdb_environment.hpp"
#include "rdf/file/space/free_pages.hpp"
#include "rdf/file/space/table_entries.hpp"
#include "rdf/store/store_snapshot.hpp"

namespace cluxel::rdf {

namespace {

constexpr const char* kFreePagesName = "free pages";
constexpr std::uint64_t kNodeHead = 8, kNodeSlot = 2;

/// A leaf holds at least two nodes; the value of a longer one has pages of its own.
std::uint64_t bytesOfEntry(std::uint64_t key, std::uint64_t value, std::uint64_t page) {
  const std::uint64_t longest = (((page - lmdb_page::kHeaderSize) / 2) & ~std::uint64_t{1}) - kNodeSlot;
  const std::uint64_t node = kNodeHead + key + value;
  if (node <= longest) return node + (node & 1U) + kNodeSlot;
  const std::uint64_t pages = (lmdb_page::kHeaderSize - 1 + value) / page + 1;
  return kNodeHead + key + sizeof(lmdb_page::PageNumber) + kNodeSlot + pages * page;
}

/// The part of the file that the commit knows.
std::uint64_t fileBytes(const ReadTransaction::Impl& state, std::uint64_t page) {
  MDB_envinfo info;
  state.check(mdb_env_info(state.environment->handle(), &info), "read the map");
  return std::min<std::uint64_t>(state.environment->fileSize(), (info.me_last_pgno + 1) * page);
}

class LayerCount {
 public:
  explicit LayerCount(const ReadTransaction& transaction) : transaction_(transaction), state_(transaction.impl()) {
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
    const std::uint64_t free = freePageCount(transaction_), all = fileBytes(state_, page_);
    std::uint64_t known = free * page_;
    for (const LayerSize& layer : layers_) known += layer.file_bytes;
    const std::uint64_t other = all - std::min(all, known);
    layers_.push_back({"other pages", other / page_, other});
    layers_.push_back({kFreePagesName, free, free * page_});
  }

  const ReadTransaction& transaction_;
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
  const std::uint64_t in_free_pages = freePageCount(transaction) * page;
  FreeSpace space{in_free_pages, fileBytes(state, page), in_free_pages, state.environment->diskBytes()};
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
