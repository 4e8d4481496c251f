// SPDX-License-Identifier: Apache-2.0
// Writes an index by appending, by single puts, or by rewriting it.
#include "rdf/store/index_writer.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "rdf/store/flush_poll.hpp"

namespace cluxel::rdf {

namespace {

// Every index stores its entries as MDB_DUPFIXED duplicates of this key.
constexpr std::string_view kIndexKey = "q";

// The cost of a single put, in keys written by appending.
constexpr std::uint64_t kPutCost = 4;

/// Calls the poll of a FlushPoll once in a while.
class EntryPoll {
 public:
  explicit EntryPoll(const ReadTransaction::Impl& transaction) : poll_(transaction.flush_poll) {}
  void count(std::size_t entries) {
    constexpr std::size_t kEntriesBetweenPolls = 4096;
    entries_ += entries;
    if (entries_ < kEntriesBetweenPolls) return;
    entries_ = 0;
    if (poll_) poll_();
  }

 private:
  const std::function<void()>& poll_;
  std::size_t entries_ = 0;
};

/// A write cursor on one index.
class IndexCursor {
 public:
  IndexCursor(ReadTransaction::Impl& transaction, Table index) : transaction_(transaction) {
    MDB_cursor* raw = nullptr;
    transaction.check(mdb_cursor_open(transaction.live(), transaction.table(index), &raw), "write an index");
    cursor_.reset(raw);
  }

  /// Keys beyond the last one, ascending.
  void append(std::span<const Key128> numbers, EntryPoll& poll) {
    constexpr std::size_t kTogether = 256;
    std::array<QuadKey, kTogether> keys;
    for (std::size_t first = 0; first < numbers.size(); first += kTogether) {
      const auto some = numbers.subspan(first, std::min(kTogether, numbers.size() - first));
      poll.count(some.size());
      std::transform(some.begin(), some.end(), keys.begin(), toKey);
      appendKeys(transaction_, cursor_.get(), std::span(keys).first(some.size()));
    }
  }

  /// False when the key was there.
  bool insert(Key128 number) {
    const int code = tryPut(number, MDB_NODUPDATA);
    if (code != MDB_KEYEXIST) transaction_.check(code, "write an index");
    return code != MDB_KEYEXIST;
  }

  /// The last key, if any.
  std::optional<Key128> last() {
    MDB_val key;
    MDB_val value;
    if (mdb_cursor_get(cursor_.get(), &key, &value, MDB_LAST) != MDB_SUCCESS) return std::nullopt;
    return toNumber(*static_cast<const QuadKey*>(value.mv_data));
  }

  MDB_cursor* get() const { return cursor_.get(); }

 private:
  int tryPut(Key128 number, unsigned flags) {
    QuadKey bytes = toKey(number);
    MDB_val key = toVal(kIndexKey);
    MDB_val value{sizeof bytes, bytes.bytes.data()};
    return mdb_cursor_put(cursor_.get(), &key, &value, flags);
  }

  ReadTransaction::Impl& transaction_;
  CursorHandle cursor_;
};

/// Tells the sum and the journal, as far as they are wanted, what has changed.
struct ChangeNotes {
  EntrySum* sum = nullptr;
  QuadJournal* journal = nullptr;

  void added(Key128 key) const {
    if (sum != nullptr) sum->add(key);
    if (journal != nullptr) journal->note(quadOf(key), true);
  }
  void removed(Key128 key) const {
    if (sum != nullptr) sum->remove(key);
    if (journal != nullptr) journal->note(quadOf(key), false);
  }
  static QuadIds quadOf(Key128 key) { return toQuad(toKey(key), QuadOrder::Spog); }
};

std::uint64_t keyCount(const ReadTransaction::Impl& transaction, Table index) {
  MDB_stat stat;
  transaction.check(mdb_stat(transaction.live(), transaction.table(index), &stat), "read an index");
  return stat.ms_entries;
}

std::vector<Key128> allKeys(ReadTransaction::Impl& transaction, Table index) {
  const IndexCursor cursor(transaction, index);
  const PageDirectory directory(cursor.get());
  std::vector<Key128> keys;
  keys.reserve(keyCount(transaction, index));
  EntryPoll poll(transaction);
  for (std::size_t i = 0; i < directory.pageCount(); ++i) {
    for (const QuadKey& key : directory.page(i)) keys.push_back(toNumber(key));
    poll.count(directory.page(i).size());
  }
  return keys;
}

void noteDifference(const std::vector<Key128>& old, const std::vector<Key128>& now, const ChangeNotes& notes) {
  std::vector<Key128> keys;
  std::set_difference(old.begin(), old.end(), now.begin(), now.end(), std::back_inserter(keys));
  for (const Key128 key : keys) notes.removed(key);
  keys.clear();
  std::set_difference(now.begin(), now.end(), old.begin(), old.end(), std::back_inserter(keys));
  for (const Key128 key : keys) notes.added(key);
}

void writeAnew(ReadTransaction::Impl& transaction, Table index, const IndexChange& change, const ChangeNotes& notes) {
  const std::vector<Key128> old = allKeys(transaction, index);
  std::vector<Key128> kept;
  kept.reserve(old.size());
  std::set_difference(old.begin(), old.end(), change.removed.begin(), change.removed.end(), std::back_inserter(kept));
  std::vector<Key128> merged;
  merged.reserve(kept.size() + change.added.size());
  std::set_union(kept.begin(), kept.end(), change.added.begin(), change.added.end(), std::back_inserter(merged));
  transaction.check(mdb_drop(transaction.live(), transaction.table(index), 0), "write an index");
  IndexCursor cursor(transaction, index);
  EntryPoll poll(transaction);
  cursor.append(merged, poll);
  if (notes.sum != nullptr || notes.journal != nullptr) noteDifference(old, merged, notes);
}

/// Uses mdb_del only: loops of mdb_cursor_del over duplicates corrupt the file in LMDB 0.9.24.
void removeSingly(ReadTransaction::Impl& transaction, Table index, const std::vector<Key128>& removed,
                  const ChangeNotes& notes) {
  EntryPoll poll(transaction);
  for (const Key128 number : removed) {
    poll.count(1);
    QuadKey bytes = toKey(number);
    MDB_val key = toVal(kIndexKey);
    MDB_val value{sizeof bytes, bytes.bytes.data()};
    const int code = mdb_del(transaction.live(), transaction.table(index), &key, &value);
    if (code == MDB_NOTFOUND) continue;
    transaction.check(code, "write an index");
    notes.removed(number);
  }
}

void addSingly(ReadTransaction::Impl& transaction, Table index, const std::vector<Key128>& added,
               const ChangeNotes& notes) {
  IndexCursor cursor(transaction, index);
  const std::optional<Key128> last = cursor.last();
  const auto beyond = last ? std::upper_bound(added.begin(), added.end(), *last) : added.begin();
  EntryPoll poll(transaction);
  for (auto key = added.begin(); key != beyond; ++key) {
    poll.count(1);
    if (cursor.insert(*key)) notes.added(*key);
  }
  cursor.append(std::span(beyond, added.end()), poll);
  for (auto key = beyond; key != added.end(); ++key) notes.added(*key);
}

}  // namespace

/// LMDB looks up the index once for all of them. What it does within the index remains: half of the time of single
/// puts.
void appendKeys(const ReadTransaction::Impl& transaction, MDB_cursor* cursor, std::span<const QuadKey> keys) {
  if (keys.empty()) return;
  MDB_val key = toVal(kIndexKey);
  std::array<MDB_val, 2> values{{{sizeof(QuadKey), const_cast<QuadKey*>(keys.data())}, {keys.size(), nullptr}}};
  transaction.check(mdb_cursor_put(cursor, &key, values.data(), MDB_APPENDDUP | MDB_MULTIPLE), "write an index");
}

void applyTo(ReadTransaction::Impl& transaction, Table index, const IndexChange& change, EntrySum* sum,
             QuadJournal* journal) {
  const ChangeNotes notes{sum, journal};
  const std::uint64_t changes = change.added.size() + change.removed.size();
  const std::uint64_t entries = keyCount(transaction, index);
  if (entries > 0 && changes * kPutCost > entries + 1000) return writeAnew(transaction, index, change, notes);
  removeSingly(transaction, index, change.removed, notes);
  addSingly(transaction, index, change.added, notes);
}

FlushPoll::FlushPoll(const ReadTransaction& transaction, std::function<void()> poll) : transaction_(transaction) {
  transaction_.impl().flush_poll = std::move(poll);
}

FlushPoll::~FlushPoll() {
  transaction_.impl().flush_poll = {};
}

}  // namespace cluxel::rdf
