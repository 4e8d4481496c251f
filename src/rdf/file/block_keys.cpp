// SPDX-License-Identifier: Apache-2.0
// Keeps and compares the sums of block keys.
#include "rdf/file/block_keys.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstring>
#include <optional>

#include "cluxel/error.hpp"
#include "rdf/file/lmdb_environment.hpp"

namespace cluxel::rdf {

namespace {

constexpr std::string_view kSumPrefix = "cluxel-keys:";

std::string sumName(std::string_view table) {
  return std::string(kSumPrefix) + std::string(table);
}

std::optional<KeySum> storedSum(const ReadTransaction::Impl& transaction, std::string_view table) {
  const std::string name = sumName(table);
  MDB_val key = toVal(name);
  MDB_val value;
  const int code = mdb_get(transaction.live(), transaction.environment->mainTable(), &key, &value);
  if (code == MDB_NOTFOUND) return std::nullopt;
  transaction.check(code, "read the sums of block keys");
  KeySum sum;
  if (value.mv_size != sizeof sum) return KeySum{~std::uint64_t{0}, 0};
  std::memcpy(&sum, value.mv_data, sizeof sum);
  return sum;
}

/// Calls `visit` with each key that starts with `first`.
template <typename Visit>
void forEachKey(const ReadTransaction::Impl& transaction, MDB_dbi table, std::string_view first, const Visit& visit) {
  MDB_cursor* raw = nullptr;
  transaction.check(mdb_cursor_open(transaction.live(), table, &raw), "read the blocks");
  const CursorHandle cursor(raw);
  MDB_val key = toVal(first);
  MDB_val stored;
  int code = mdb_cursor_get(raw, &key, &stored, MDB_SET_RANGE);
  for (; code == MDB_SUCCESS; code = mdb_cursor_get(raw, &key, &stored, MDB_NEXT)) {
    if (!toView(key).starts_with(first)) return;
    visit(toView(key));
  }
  if (code != MDB_NOTFOUND) transaction.check(code, "read the blocks");
}

template <typename Visit>
void forEachBlockKey(const ReadTransaction::Impl& transaction, std::string_view table, const Visit& visit) {
  std::string first(table);
  first += '\0';
  forEachKey(transaction, transaction.table(Table::Blocks), first, visit);
}

[[noreturn]] void failKeys(const ReadTransaction::Impl& transaction, std::string_view table, const std::string& what) {
  throw Error(ErrorKind::StoreUnavailable, transaction.environment->file().string() + ": the keys of the blocks '" +
                                               std::string(table) + "' are damaged (" + what +
                                               "); take a copy of the map or build it again");
}

bool isFound(const ReadTransaction::Impl& transaction, std::string_view full_key) {
  MDB_val key = toVal(full_key);
  MDB_val stored;
  return mdb_get(transaction.live(), transaction.table(Table::Blocks), &key, &stored) == MDB_SUCCESS;
}

/// Reads the keys of a table, and looks up each one.
KeySum readKeys(const ReadTransaction::Impl& transaction, std::string_view table) {
  KeySum present;
  forEachBlockKey(transaction, table, [&](std::string_view key) {
    present.add(key);
    if (!isFound(transaction, key)) failKeys(transaction, table, "a key is out of order");
  });
  return present;
}

}  // namespace

void KeySum::add(std::string_view full_key) {
  ++count;
  hash += XXH3_64bits(full_key.data(), full_key.size());
}

void KeySum::remove(std::string_view full_key) {
  --count;
  hash -= XXH3_64bits(full_key.data(), full_key.size());
}

void PresentKeys::add(std::string_view full_key) {
  const std::string_view table = full_key.substr(0, full_key.find('\0'));
  auto entry = of_table.find(table);
  if (entry == of_table.end()) entry = of_table.emplace(table, KeySum{}).first;
  entry->second.add(full_key);
}

BlockKeys::Table& BlockKeys::changed(const ReadTransaction::Impl& transaction, std::string_view table) {
  Table& entry = tables_.try_emplace(std::string(table)).first->second;
  if (entry.is_changed) return entry;
  entry.is_changed = true;
  if (const auto stored = storedSum(transaction, table))
    entry.sum = *stored;
  else
    forEachBlockKey(transaction, table, [&](std::string_view key) { entry.sum.add(key); });
  entry.before = entry.sum;
  return entry;
}

void BlockKeys::noteAdded(const ReadTransaction::Impl& transaction, std::string_view table, std::string_view full_key) {
  changed(transaction, table).sum.add(full_key);
}

void BlockKeys::noteRemoved(const ReadTransaction::Impl& transaction, std::string_view table,
                            std::string_view full_key) {
  changed(transaction, table).sum.remove(full_key);
}

void BlockKeys::store(const ReadTransaction::Impl& transaction) const {
  for (const auto& [table, entry] : tables_) {
    if (!entry.is_changed) continue;
    const std::string name = sumName(table);
    MDB_val key = toVal(name);
    MDB_val value{sizeof entry.sum, const_cast<KeySum*>(&entry.sum)};
    transaction.check(mdb_put(transaction.live(), transaction.environment->mainTable(), &key, &value, 0),
                      "write the sums of block keys");
  }
}

void BlockKeys::verify(const ReadTransaction::Impl& transaction, std::string_view table) {
  Table& entry = tables_.try_emplace(std::string(table)).first->second;
  if (entry.is_changed || entry.is_verified) return;
  const auto stored = storedSum(transaction, table);
  if (stored) {
    const std::optional<KeySum> known = transaction.environment->presentKeys(transaction.commitBefore(), table);
    const KeySum present = known ? *known : readKeys(transaction, table);
    if (present != *stored)
      failKeys(transaction, table,
               std::to_string(stored->count) + " were written, " + std::to_string(present.count) + " are there" +
                   (present.count == stored->count ? ", some of them changed" : ""));
  }
  entry.is_verified = true;
}

PresentKeys BlockKeys::after(PresentKeys before) const {
  for (const auto& [table, entry] : tables_) {
    if (!entry.is_changed) continue;
    KeySum& present = before.of_table[table];
    present.count += entry.sum.count - entry.before.count;
    present.hash += entry.sum.hash - entry.before.hash;
  }
  return before;
}

std::vector<std::string> BlockKeys::tablesOf(const ReadTransaction::Impl& transaction) {
  std::vector<std::string> tables;
  forEachKey(transaction, transaction.environment->mainTable(), kSumPrefix,
             [&](std::string_view name) { tables.emplace_back(name.substr(kSumPrefix.size())); });
  return tables;
}

}  // namespace cluxel::rdf
