// SPDX-License-Identifier: Apache-2.0
// Lists of pages stay right as long as LMDB leaves the pages that it wrote where they are.
#include "rdf/store/indexes/index_directories.hpp"

#include <algorithm>
#include <vector>

#include "rdf/file/directory_update.hpp"
#include "rdf/file/lmdb_environment.hpp"
#include "rdf/store/indexes/index_draft.hpp"
#include "rdf/store/store_snapshot.hpp"

namespace cluxel::rdf {

namespace {

/// LMDB keeps up to 131,071 written pages in memory, unless it is made to write them. When there are more, it writes
/// some to the file and uses their memory for others, so that lists of pages are wrong.
constexpr std::uint64_t kMaxDirtyPages = 100'000;

std::size_t numberOf(Table index) {
  return static_cast<std::size_t>(index);
}

}  // namespace

void IndexDirectories::startFrom(std::shared_ptr<StoreSnapshot> committed) {
  if (committed->isMapped()) committed_ = std::move(committed);
}

bool IndexDirectories::mayMovePages() const {
  std::uint64_t pages = other_pages_;
  for (const Entry& entry : entries_) pages += 2 * entry.dirty_pages;  // with the pages above them
  return pages > kMaxDirtyPages;
}

std::shared_ptr<const PageDirectory> IndexDirectories::of(Table index, Transaction& transaction) {
  Entry& entry = entries_[numberOf(index)];
  const IndexDraft* draft = transaction.draftOf(index);
  if (entry.directory && (draft != nullptr || entry.is_committed || !mayMovePages())) return entry.directory;
  if (draft != nullptr)
    entry.directory = std::make_shared<const PageDirectory>(draft->directory());
  else if (committed_ && entry.is_committed)
    entry.directory = committed_->sharedDirectory(index, transaction);
  else
    entry.directory = std::make_shared<const PageDirectory>(ofTable(index, transaction));
  return entry.directory;
}

PageDirectory IndexDirectories::ofTable(Table index, Transaction& transaction) {
  const std::shared_ptr<const PageGuard> guard = guardOf(index, transaction);
  if (guard) guard->requireAllWellFormed();
  PageDirectory directory(transaction.cursorOn(index, "read an index").get());
  directory.guardBy(guard);
  return directory;
}

std::shared_ptr<const PageGuard> IndexDirectories::guardOf(Table index, Transaction& transaction) const {
  if (!committed_ || !committed_->isComparedByParts()) return nullptr;
  return committed_->sharedDirectory(index, transaction)->guard();
}

void IndexDirectories::requireWellFormed(Table index, Transaction& transaction, std::span<const Key128> added,
                                         std::span<const Key128> removed) {
  const std::shared_ptr<const PageGuard> guard = guardOf(index, transaction);
  if (!guard) return;
  guard->requireWellFormed(added);
  guard->requireWellFormed(removed);
}

void IndexDirectories::noteKeys(Table index, Transaction& transaction, std::span<const Key128> added,
                                std::span<const Key128> removed) {
  if (added.empty() && removed.empty()) return;
  Entry& entry = entries_[numberOf(index)];
  if (committed_ && entry.is_committed) entry.directory = committed_->sharedDirectory(index, transaction);
  entry.is_committed = false;
  if (!committed_ || !entry.directory || mayMovePages()) return noteRewritten(index, added.size() + removed.size());
  std::vector<Key128> changed;
  changed.reserve(added.size() + removed.size());
  std::merge(added.begin(), added.end(), removed.begin(), removed.end(), std::back_inserter(changed));
  auto updated = updatedDirectory(*entry.directory, changed, committed_->map(),
                                  transaction.cursorOn(index, "read an index").get());
  if (!updated) return noteRewritten(index, changed.size());
  entry.directory = std::make_shared<const PageDirectory>(std::move(updated->directory));
  entry.dirty_pages = updated->dirty_pages;
}

void IndexDirectories::noteDrafted(Table index) {
  Entry& entry = entries_[numberOf(index)];
  entry.directory = nullptr;
  entry.is_committed = false;
}

void IndexDirectories::notePagesWritten() {
  for (Entry& entry : entries_)
    if (!entry.is_committed) entry.directory = nullptr, entry.dirty_pages = 0;
  other_pages_ = 0;
}

void IndexDirectories::noteRewritten(Table index, std::uint64_t keys) {
  noteDrafted(index);
  other_pages_ += keys;  // at most one page a key
}

}  // namespace cluxel::rdf
