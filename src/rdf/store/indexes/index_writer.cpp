// SPDX-License-Identifier: Apache-2.0
// Writes an index by appending, by single puts, or as a draft that is appended when the transaction commits.
#include "rdf/store/indexes/index_writer.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "base/parallel.hpp"
#include "rdf/store/flush_poll.hpp"
#include "rdf/store/indexes/changed_ranges.hpp"
#include "rdf/store/indexes/index_directories.hpp"
#include "rdf/store/indexes/index_draft.hpp"

namespace cluxel::rdf {

namespace {

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
  IndexCursor(ReadTransaction::Impl& transaction, Table index)
      : transaction_(transaction), cursor_(transaction.cursorOn(index, "write an index")) {}

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

/// Tells the sums and the journal of a task, as far as they are wanted, what has changed.
struct ChangeNotes {
  explicit ChangeNotes(const IndexTask& of, RangeSums* sums_of_ranges = nullptr) : task(of), ranges(sums_of_ranges) {}

  void added(Key128 key) const {
    const Key128 in_sum = keyInSumOf(task.index, key);
    if (task.sum != nullptr) task.sum->add(in_sum);
    if (isNumber(in_sum)) task.sum_of_numbers->add(in_sum);
    if (ranges != nullptr) ranges->add(key, in_sum);
    if (task.journal != nullptr) task.journal->note(quadOf(in_sum), true);
  }
  void removed(Key128 key) const {
    const Key128 in_sum = keyInSumOf(task.index, key);
    if (task.sum != nullptr) task.sum->remove(in_sum);
    if (isNumber(in_sum)) task.sum_of_numbers->remove(in_sum);
    if (ranges != nullptr) ranges->remove(key, in_sum);
    if (task.journal != nullptr) task.journal->note(quadOf(in_sum), false);
  }

 private:
  static QuadIds quadOf(Key128 in_sum) { return toQuad(toKey(in_sum), QuadOrder::Spog); }
  bool isNumber(Key128 in_sum) const { return task.sum_of_numbers != nullptr && task.is_number(quadOf(in_sum).o); }

  const IndexTask& task;
  RangeSums* ranges;
};

std::uint64_t keyCount(const ReadTransaction::Impl& transaction, Table index) {
  if (const IndexDraft* draft = transaction.draftOf(index)) return draft->size();
  MDB_stat stat;
  transaction.check(mdb_stat(transaction.live(), transaction.table(index), &stat), "read an index");
  return stat.ms_entries;
}

std::unique_ptr<IndexDraft> draftFrom(ReadTransaction::Impl& transaction, Table index) {
  const PageDirectory directory = transaction.directories->ofTable(index, transaction);
  auto draft = std::make_unique<IndexDraft>(transaction.environment->file().parent_path());
  EntryPoll poll(transaction);
  for (std::size_t i = 0; i < directory.pageCount(); ++i) {
    for (const QuadKey& key : directory.page(i)) draft->append(toNumber(key));
    poll.count(directory.page(i).size());
  }
  return draft;
}

void writeDraft(ReadTransaction::Impl& transaction, Table index) {
  const std::unique_ptr<IndexDraft> draft = std::move(transaction.drafts[static_cast<std::size_t>(index)]);
  transaction.check(mdb_drop(transaction.live(), transaction.table(index), 0), "write an index");
  const IndexCursor cursor(transaction, index);
  EntryPoll poll(transaction);
  RangeSummer sums(index);
  for (std::size_t i = 0; i < draft->pageCount(); ++i) {
    poll.count(draft->page(i).size());
    appendKeys(transaction, cursor.get(), draft->page(i));
    transaction.noteWritten(draft->page(i).size_bytes());
    if (transaction.environment->hasRanges()) sums.add(draft->page(i));
  }
  transaction.directories->noteRewritten(index, draft->pageCount());
  if (transaction.environment->hasRanges()) transaction.ranges->replace(index, sums.take());
}

/// Whether the change goes to a draft, which is there then.
bool isDrafted(ReadTransaction::Impl& transaction, Table index, std::uint64_t changes) {
  const std::uint64_t entries = keyCount(transaction, index);
  std::unique_ptr<IndexDraft>& draft = transaction.drafts[static_cast<std::size_t>(index)];
  if (draft) return true;
  if (changes * kPutCost <= entries + 1000) return false;
  draft = draftFrom(transaction, index);
  transaction.directories->noteDrafted(index);
  return true;
}

void changeDraft(ReadTransaction::Impl& transaction, Table index, const IndexChange& change, const ChangeNotes& notes) {
  transaction.directories->noteDrafted(index);
  EntryPoll poll(transaction);
  transaction.draftOf(index)->change(change.added, change.removed,
                                     {[&](Key128 key) { notes.added(key); }, [&](Key128 key) { notes.removed(key); },
                                      [&](std::size_t keys) { poll.count(keys); }});
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

namespace {

void writeSingly(ReadTransaction::Impl& transaction, const IndexTask& task) {
  if (task.change.added.empty() && task.change.removed.empty()) return;
  transaction.directories->requireWellFormed(task.index, transaction, task.change.added, task.change.removed);
  const ChangeNotes notes(
      task, transaction.environment->hasRanges() ? &transaction.ranges->of(task.index, transaction) : nullptr);
  removeSingly(transaction, task.index, task.change.removed, notes);
  addSingly(transaction, task.index, task.change.added, notes);
  transaction.directories->noteKeys(task.index, transaction, task.change.added, task.change.removed);
}

}  // namespace

/// LMDB has one writer: only what happens in memory runs on several threads. A poll may be called by one thread only.
void applyTo(ReadTransaction::Impl& transaction, std::span<IndexTask> tasks, std::size_t count,
             const std::function<void(IndexTask&)>& make) {
  std::vector<char> is_drafted;
  for (const IndexTask& task : tasks) is_drafted.push_back(isDrafted(transaction, task.index, count) ? 1 : 0);
  parallelFor(tasks.size(), transaction.flush_poll ? 1 : transaction.threads, [&](std::size_t i) {
    make(tasks[i]);
    if (is_drafted[i] == 0) return;
    changeDraft(transaction, tasks[i].index, tasks[i].change, ChangeNotes(tasks[i]));
    tasks[i].change = {};
  });
  for (std::size_t i = 0; i < tasks.size(); ++i)
    if (is_drafted[i] == 0) writeSingly(transaction, tasks[i]);
}

void writeDrafts(ReadTransaction::Impl& transaction) {
  for (std::size_t i = 0; i < kTableCount; ++i)
    if (transaction.drafts[i]) writeDraft(transaction, static_cast<Table>(i));
}

FlushPoll::FlushPoll(const ReadTransaction& transaction, std::function<void()> poll) : transaction_(transaction) {
  transaction_.impl().flush_poll = std::move(poll);
}

FlushPoll::~FlushPoll() {
  transaction_.impl().flush_poll = {};
}

}  // namespace cluxel::rdf
