// SPDX-License-Identifier: Apache-2.0
// Transactions: snapshots, commits, and the file format check.
#include <charconv>
#include <stdexcept>
#include <utility>

#include "cluxel/error.hpp"
#include "rdf/file/check/map_structure.hpp"
#include "rdf/file/lmdb_environment.hpp"
#include "rdf/file/map_check.hpp"
#include "rdf/file/map_replacement.hpp"
#include "rdf/file/opening/newest_commit.hpp"
#include "rdf/store/indexes/changed_ranges.hpp"
#include "rdf/store/indexes/index_directories.hpp"
#include "rdf/store/indexes/index_draft.hpp"
#include "rdf/store/indexes/index_writer.hpp"
#include "rdf/store/store_snapshot.hpp"
#include "rdf/terms/value_cache.hpp"

namespace cluxel::rdf {

namespace {

constexpr std::string_view kFormatKey = "cluxel-format";
constexpr int kFormat = kMapFormat;

int checkedFormat(const std::string& text, const std::filesystem::path& file) {
  int format = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), format);
  if (read.ec != std::errc() || read.ptr != text.data() + text.size()) format = 0;
  if (format >= kFirstFormat && format <= kFormat) return format;
  const std::string what = format > kFormat ? "is a map of a newer format (" + text + "; this program reads " +
                                                  std::to_string(kFormat) + "); use a newer Cluxel"
                                            : "is a map of an unknown format; build it again";
  throw Error(ErrorKind::StoreUnavailable, file.string() + ": " + what);
}

void writeFormat(const ReadTransaction::Impl& transaction, int version) {
  const std::string format = std::to_string(version);
  MDB_val key = toVal(kFormatKey);
  MDB_val value = toVal(format);
  transaction.check(mdb_put(transaction.live(), transaction.environment->mainTable(), &key, &value, 0),
                    "write the format");
}

}  // namespace

void makeSums(WriteTransaction& transaction) {
  ReadTransaction::Impl& state = transaction.impl();
  StoreSnapshot& snapshot = snapshotOf(state);
  const std::filesystem::path& file = state.environment->file();
  state.sums.quads = state.sums.links = sumOf(snapshot.directory(Table::Spog, state), Table::Spog, file);
  state.sums.term_hashes = sumOf(snapshot.directory(Table::TermHashes, state), Table::TermHashes, file);
  TermSumWriter terms(transaction);
  for (std::uint64_t id = 1; id <= snapshot.termCount(); ++id) {
    const auto term = static_cast<TermId>(id);
    terms.add(hashOfRecord(snapshot.record(term, state)), term);
  }
  terms.store();
  writeFormat(state, kFormatWithSums);
}

void LmdbEnvironment::createTables(ReadTransaction::Impl& transaction) {
  for (std::size_t i = 0; i < kTableCount; ++i)
    check(mdb_dbi_open(transaction.live(), kTableNames[i], tableFlags(static_cast<Table>(i)) | MDB_CREATE, &tables_[i]),
          "make the map's tables");
  writeFormat(transaction, kFormat);
  ++transaction.generation;
}

void LmdbEnvironment::openTables() {
  MDB_txn* raw = nullptr;
  check(mdb_txn_begin(handle(), nullptr, MDB_RDONLY, &raw), "read the map");
  TxnHandle transaction(raw);
  check(mdb_dbi_open(raw, nullptr, 0, &main_), "read the map");
  MDB_val key = toVal(kFormatKey);
  MDB_val value;
  const int found = mdb_get(raw, main_, &key, &value);
  if (found == MDB_SUCCESS) {
    format_ = checkedFormat(std::string(toView(value)), file_);
    for (std::size_t i = 0; i < kTableCount; ++i) {
      const auto table = static_cast<Table>(i);
      if (table == Table::Psog && !keepsNumbersApart()) continue;
      check(mdb_dbi_open(raw, kTableNames[i], tableFlags(table), &tables_[i]), "read the map's tables");
    }
    check(mdb_txn_commit(transaction.release()), "read the map's tables");
    return;
  }
  if (found != MDB_NOTFOUND) check(found, "read the map");
  MDB_stat main_stat;
  check(mdb_stat(raw, main_, &main_stat), "read the map");
  transaction.reset();
  if (main_stat.ms_entries != 0)
    throw Error(ErrorKind::StoreUnavailable, file_.string() + ": is an LMDB file, but not a Cluxel map");
  if (!writing_allowed_)
    throw Error(ErrorKind::StoreUnavailable, file_.string() + ": holds no map yet; build it first");
  verified_ = true;  // there is nothing yet
  WriteTransaction first = write();
  createTables(first.impl());
  first.commit();
}

ReadTransaction LmdbEnvironment::read() const {
  refuseParents();
  auto impl = std::make_shared<ReadTransaction::Impl>();
  // The shared state is protected by a mutex.
  impl->environment = std::static_pointer_cast<LmdbEnvironment>(const_cast<LmdbEnvironment*>(this)->shared_from_this());
  check(mdb_txn_begin(handle(), nullptr, MDB_RDONLY, &impl->txn), "read the map");
  if (!seesNewest(impl->txn)) throw LockFileOutdated(file_);
  return ReadTransaction(std::move(impl));
}

WriteTransaction LmdbEnvironment::write() {
  auto impl = std::make_shared<ReadTransaction::Impl>();
  impl->environment = std::static_pointer_cast<LmdbEnvironment>(shared_from_this());
  enterWriting();
  impl->writing = true;
  const int code = mdb_txn_begin(handle(), nullptr, 0, &impl->txn);
  if (code != MDB_SUCCESS) impl->end();
  check(code, "write the map");
  const std::size_t base = mdb_txn_id(impl->txn) - 1;
  if (base != newestCommit(handle())) {  // a commit on an older one would undo the newest
    impl->end();
    throw LockFileOutdated(file_);
  }
  MDB_stat terms;
  if (mdb_stat(impl->txn, table(Table::Terms), &terms) == MDB_SUCCESS) impl->committed_terms = terms.ms_entries;
  WriteTransaction transaction(std::move(impl));
  if (!verified_) verifyForWriting(base);
  cutUnusedEnd();
  if (base > 0) {
    startSums(transaction, base);
    const ReadTransaction current = read();
    const std::shared_ptr<StoreSnapshot> snapshot = sharedSnapshotOf(current.impl());
    snapshot->prepareForWriting(current.impl());
    transaction.impl().directories->startFrom(snapshot);
  }
  restartJournal(transaction);
  return transaction;
}

/// LMDB trusts every page that it reads. What a writer reads is compared when it is read; of maps without sums of
/// ranges all is compared before.
void LmdbEnvironment::verifyForWriting(std::size_t commit) {
  const ReadTransaction current = read();
  StoreSnapshot& snapshot = snapshotOf(current.impl());
  const bool by_parts = snapshot.isComparedByParts();
  if (!by_parts || structure_commit_ != commit)
    checkMapStructure(data_lock_, file_, commit, by_parts ? MapScope::Writing : MapScope::Whole, snapshot.map().base);
  if (!by_parts) snapshot.verify(current.impl());
  verified_ = true;
}

void LmdbEnvironment::noteStructure(std::size_t commit, bool for_writing, PresentKeys keys) {
  if (for_writing) structure_commit_ = commit;
  const std::lock_guard lock(checked_mutex_);
  keys_commit_ = commit;
  keys_ = std::move(keys);
}

std::optional<KeySum> LmdbEnvironment::presentKeys(std::size_t commit, std::string_view table) const {
  const std::lock_guard lock(checked_mutex_);
  if (keys_commit_ != commit || commit == 0 || !keys_.in_order) return std::nullopt;
  const auto known = keys_.of_table.find(table);
  return known == keys_.of_table.end() ? KeySum{} : known->second;
}

void LmdbEnvironment::noteCommit(std::size_t transaction_id, std::shared_ptr<CheckedParts> checked,
                                 const BlockKeys& keys) {
  if (format_ == kFirstFormat) format_ = kFormatWithSums;
  const std::lock_guard lock(checked_mutex_);
  checked_ = std::move(checked);
  own_commit_ = transaction_id;
  if (keys_commit_ == 0 || keys_commit_ + 1 != transaction_id) return;
  keys_ = keys.after(std::move(keys_));
  keys_commit_ = transaction_id;
}

std::shared_ptr<CheckedParts> LmdbEnvironment::checkedPartsOf(std::size_t transaction_id) const {
  const std::lock_guard lock(checked_mutex_);
  return checked_ && wrote(transaction_id) ? checked_ : std::make_shared<CheckedParts>();
}

/// What is copied was verified in the other file. LMDB numbers the commit of a copy anew.
void LmdbEnvironment::startWithPagesOf(const LmdbEnvironment& other, const StoreSums& sums) {
  startCopyOf(other);
  copied_sums_ = sums;
  verified_ = true;
  own_commit_ = mdb_txn_id(read().impl().live());
}

void LmdbEnvironment::startSums(WriteTransaction& transaction, std::size_t commit) {
  if (copied_sums_)
    transaction.impl().sums = *std::exchange(copied_sums_, {});
  else if (const auto sums = storedSums(transaction.impl(), commit))
    transaction.impl().sums = *sums;
  else
    makeSums(transaction);
}

std::shared_ptr<StoreSnapshot> LmdbEnvironment::snapshot(
    std::size_t transaction_id, const std::function<std::shared_ptr<StoreSnapshot>()>& make) const {
  const std::lock_guard lock(snapshot_mutex_);
  if (snapshot_ && snapshot_transaction_ == transaction_id) return snapshot_;
  std::shared_ptr<StoreSnapshot> made = make();
  if (!snapshot_ || transaction_id > snapshot_transaction_) {
    snapshot_ = made;
    snapshot_transaction_ = transaction_id;
  }
  return made;
}

ReadTransaction::Impl::Impl()
    : directories(std::make_unique<IndexDirectories>()), ranges(std::make_unique<ChangedRanges>()) {}

ReadTransaction::Impl::~Impl() {
  end();
}

void ReadTransaction::Impl::end() {
  for (auto& draft : drafts) draft.reset();
  if (environment && environment->isOfParent()) {  // who goes on reading, or writing
    txn = nullptr;
    writing = false;
  }
  if (txn != nullptr) mdb_txn_abort(std::exchange(txn, nullptr));
  if (std::exchange(writing, false)) environment->leaveWriting();
}

MDB_txn* ReadTransaction::Impl::live() const {
  if (txn == nullptr) throw std::logic_error("the transaction has ended");
  environment->refuseParents();
  return txn;
}

/// LMDB writes pages when it has 131,071 of them, but a long value counts as one page, whatever its length. So it is
/// asked to store a value that leaves room for no page, under the key of a table, which it then refuses.
void ReadTransaction::Impl::writePages() {
  constexpr std::size_t kMostPages = 131'072;
  unwritten_bytes = 0;
  MDB_stat stat;
  check(mdb_stat(live(), environment->mainTable(), &stat), "write the map");
  MDB_val key = toVal(kTableNames[static_cast<std::size_t>(Table::Blocks)]);
  MDB_val refused{kMostPages / 2 * stat.ms_psize, nullptr};  // LMDB counts a value twice
  const int code = mdb_put(live(), environment->mainTable(), &key, &refused, 0);
  // What was read of these pages lies in memory that LMDB has freed.
  directories->notePagesWritten();
  snapshot.reset();
  if (code != MDB_INCOMPATIBLE && code != MDB_BAD_VALSIZE) check(code, "write the map");
}

void ReadTransaction::Impl::noteWritten(std::uint64_t bytes) {
  constexpr std::uint64_t kMostUnwritten = 64 << 20;
  unwritten_bytes += bytes;
  if (unwritten_bytes >= kMostUnwritten) writePages();
}

void WriteTransaction::writePages() {
  impl().writePages();
}

void ReadTransaction::Impl::requireSound() const {
  if (has_failed)
    throw Error(ErrorKind::StoreUnavailable, environment->file().string() +
                                                 ": a change of this transaction failed before, and nothing of it can "
                                                 "be read or written; roll it back and repeat it");
}

CursorHandle ReadTransaction::Impl::cursorOn(Table which, std::string_view doing) const {
  MDB_cursor* raw = nullptr;
  check(mdb_cursor_open(live(), table(which), &raw), doing);
  return CursorHandle(raw);
}

void WriteTransaction::useThreads(unsigned threads) {
  impl().threads = threads;
}

ReadTransaction WriteTransaction::before() const {
  return impl().environment->read();
}

std::uint64_t ReadTransaction::commitNumber() const {
  return mdb_txn_id(impl_->live()) - (impl_->writing ? 1 : 0);
}

void WriteTransaction::writeIndexes() {
  impl().live();
  impl().requireSound();
  writeDrafts(impl());
  ++impl().generation;  // so that readers look for them in the file
}

void WriteTransaction::commit() {
  Impl& state = impl();
  state.live();
  state.requireSound();
  const std::size_t id = mdb_txn_id(state.txn);
  writeDrafts(state);
  if (state.generation > 0) {
    state.ranges->store(*this);
    state.block_keys.store(state);
    state.sums.transaction = id;
    storeSums(state, state.sums);
  }
  const std::shared_ptr<StoreSnapshot>& before = state.directories->committed();
  const int code = mdb_txn_commit(std::exchange(state.txn, nullptr));
  if (code == MDB_SUCCESS && state.generation > 0)
    state.environment->noteCommit(id, before ? before->checkedParts() : nullptr, state.block_keys);
  state.end();
  state.check(code, "write the map");
}

}  // namespace cluxel::rdf
