// SPDX-License-Identifier: Apache-2.0
// Blocks: byte strings with a checksum in one LMDB database, under "table, zero byte, key", so that the blocks of a
// table are adjacent.
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstring>
#include <stdexcept>

#include "cluxel/error.hpp"
#include "rdf/file/check/map_file_head.hpp"
#include "rdf/file/lmdb_environment.hpp"
#include "rdf/store/indexes/index_directories.hpp"
#include "rdf/store/store_snapshot.hpp"

namespace cluxel::rdf {

namespace {

constexpr std::size_t kMaxKeyBytes = 511;

/// The header of a block; 16 bytes, so that the data of a long block is aligned to 16.
struct BlockHead {
  std::uint64_t checksum, size;
};

std::string fullKey(std::string_view table, std::string_view key) {
  std::string full(table);
  full += '\0';
  full += key;
  if (full.size() > kMaxKeyBytes) throw std::length_error("a block's table and key are longer than 510 bytes");
  return full;
}

/// The checksum covers the key, so that a block under a wrong key is detected.
std::uint64_t checksumOf(std::string_view full_key, std::string_view bytes) {
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), XXH3_64bits(full_key.data(), full_key.size()));
}

/// LMDB gives back as many pages of a long value as the head of the first one states. To be called before a stored
/// block is written over or erased.
void requireHead(const ReadTransaction::Impl& transaction, const MDB_val& stored) {
  const std::shared_ptr<StoreSnapshot>& committed = transaction.directories->committed();
  if (!committed || !committed->isMapped()) return;  // then the whole file was looked at
  const PageMap& map = committed->map();
  const auto* bytes = static_cast<const std::uint8_t*>(stored.mv_data);
  if (bytes < map.base || bytes >= map.base + map.page_count * map.page_size) return;  // of this transaction
  const auto place = static_cast<std::uint64_t>(bytes - map.base);
  if (place % map.page_size != lmdb_page::kHeaderSize) return;  // a short one
  const lmdb_page::PageNumber first = place / map.page_size;
  if (!lmdb_page::isHeadOfLongValue(map.page(first), first, lmdb_page::pagesOfLongValue(stored.mv_size, map.page_size)))
    refuseDamaged(transaction.environment->file(), "page " + std::to_string(first) + " is of the wrong kind");
}

}  // namespace

std::string_view verifiedBlock(std::string_view full_key, std::string_view stored, const std::filesystem::path& file) {
  BlockHead head{};
  if (stored.size() >= sizeof head) std::memcpy(&head, stored.data(), sizeof head);
  const std::string_view bytes = stored.substr(std::min(stored.size(), sizeof head));
  if (stored.size() < sizeof head || head.size != bytes.size() || head.checksum != checksumOf(full_key, bytes)) {
    const std::size_t zero = full_key.find('\0');
    throw Error(ErrorKind::StoreUnavailable, file.string() + ": a block of '" + std::string(full_key.substr(0, zero)) +
                                                 "' has a wrong checksum; take a copy of the map or build it again");
  }
  return bytes;
}

std::optional<std::string_view> readBlock(ReadTransaction::Impl& transaction, std::string_view table,
                                          std::string_view key) {
  const std::string full = fullKey(table, key);
  MDB_val stored_key = toVal(full);
  MDB_val stored;
  const int code = mdb_get(transaction.live(), transaction.table(Table::Blocks), &stored_key, &stored);
  if (code == MDB_NOTFOUND) {
    transaction.block_keys.verify(transaction, table);
    return std::nullopt;
  }
  transaction.check(code, "read a block");
  return verifiedBlock(full, toView(stored), transaction.environment->file());
}

std::optional<std::string_view> ReadTransaction::block(std::string_view table, std::string_view key) const {
  return readBlock(*impl_, table, key);
}

void ReadTransaction::forEachBlock(
    std::string_view table, std::string_view prefix,
    const std::function<void(std::string_view key, std::string_view bytes)>& visit) const {
  impl_->block_keys.verify(*impl_, table);
  MDB_cursor* raw = nullptr;
  impl_->check(mdb_cursor_open(impl_->live(), impl_->table(Table::Blocks), &raw), "read the blocks");
  const CursorHandle cursor(raw);
  const std::string first = fullKey(table, prefix);
  MDB_val key = toVal(first);
  MDB_val stored;
  int code = mdb_cursor_get(raw, &key, &stored, MDB_SET_RANGE);
  for (; code == MDB_SUCCESS; code = mdb_cursor_get(raw, &key, &stored, MDB_NEXT)) {
    const std::string_view full = toView(key);
    if (!full.starts_with(first)) return;
    visit(full.substr(table.size() + 1), verifiedBlock(full, toView(stored), impl_->environment->file()));
  }
  if (code != MDB_NOTFOUND) impl_->check(code, "read the blocks");
}

void WriteTransaction::putBlock(std::string_view table, std::string_view key, std::string_view bytes) {
  const std::string full = fullKey(table, key);
  const BlockHead head{checksumOf(full, bytes), bytes.size()};
  MDB_val stored_key = toVal(full);
  MDB_val stored;
  const int there = mdb_get(impl_->live(), impl_->table(Table::Blocks), &stored_key, &stored);
  if (there == MDB_NOTFOUND)
    impl_->block_keys.noteAdded(*impl_, table, full);
  else
    impl_->check(there, "write a block");
  if (there == MDB_SUCCESS) requireHead(*impl_, stored);
  // LMDB writes over a value of the same transaction and leaves it the pages that a longer one had: the table would
  // then have more pages than its values need, which a check of the file takes for damage.
  if (there == MDB_SUCCESS && stored.mv_size > sizeof head + bytes.size())
    impl_->check(mdb_del(impl_->live(), impl_->table(Table::Blocks), &stored_key, nullptr), "replace a block");
  stored = {sizeof head + bytes.size(), nullptr};
  const int code = mdb_put(impl_->live(), impl_->table(Table::Blocks), &stored_key, &stored, MDB_RESERVE);
  impl_->check(code, "write a block");
  std::memcpy(stored.mv_data, &head, sizeof head);
  if (!bytes.empty()) std::memcpy(static_cast<char*>(stored.mv_data) + sizeof head, bytes.data(), bytes.size());
  ++impl_->generation;
  impl_->directories->noteBlock(bytes.size());
  impl_->noteWritten(bytes.size());
}

bool WriteTransaction::putIfDifferent(std::string_view table, std::string_view key, std::string_view bytes) {
  if (block(table, key) == bytes) return false;
  putBlock(table, key, bytes);
  return true;
}

bool WriteTransaction::eraseBlock(std::string_view table, std::string_view key) {
  const std::string full = fullKey(table, key);
  MDB_val stored_key = toVal(full);
  MDB_val stored;
  const int there = mdb_get(impl_->live(), impl_->table(Table::Blocks), &stored_key, &stored);
  if (there == MDB_NOTFOUND) return false;
  impl_->check(there, "erase a block");
  requireHead(*impl_, stored);
  impl_->block_keys.noteRemoved(*impl_, table, full);
  impl_->check(mdb_del(impl_->live(), impl_->table(Table::Blocks), &stored_key, nullptr), "erase a block");
  ++impl_->generation;
  impl_->directories->noteBlock(0);
  return true;
}

}  // namespace cluxel::rdf
