// SPDX-License-Identifier: Apache-2.0
// A page on which changes fall is written anew, as one page or as several with equal numbers of keys. Keys beyond the
// last one are appended, which fills pages.
#include "rdf/store/indexes/index_draft.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace cluxel::rdf {

namespace {

QuadKey* keysOf(std::uint8_t* page) {
  return reinterpret_cast<QuadKey*>(page + lmdb_page::kHeaderSize);
}

void setCount(std::uint8_t* page, std::size_t count) {
  const auto lower = static_cast<std::uint16_t>(lmdb_page::kHeaderSize + 2 * count);
  std::memcpy(page + offsetof(lmdb_page::Header, lower), &lower, sizeof lower);
}

/// Changes in order, of which those of one page are merged with its keys.
class PageMerge {
 public:
  PageMerge(std::span<const Key128> added, std::span<const Key128> removed, const IndexDraft::Listener& listener)
      : added_(added), removed_(removed), listener_(listener) {}

  bool hasBefore(Key128 key) const {
    return (!added_.empty() && added_.front() < key) || (!removed_.empty() && removed_.front() < key);
  }

  /// The keys of a page after the changes before `beyond`.
  std::span<const Key128> merge(std::span<const QuadKey> page, Key128 beyond) {
    merged_.clear();
    for (const QuadKey& entry : page) {
      const Key128 key = toNumber(entry);
      while (!added_.empty() && added_.front() < key) add();
      if (!added_.empty() && added_.front() == key) added_ = added_.subspan(1);
      if (isRemoved(key))
        listener_.removed(key);
      else
        merged_.push_back(key);
    }
    while (!added_.empty() && added_.front() < beyond) add();
    while (!removed_.empty() && removed_.front() < beyond) removed_ = removed_.subspan(1);
    listener_.has_merged(page.size() + merged_.size());
    return merged_;
  }

  /// The keys to be added that are left.
  std::span<const Key128> rest() const { return added_; }

 private:
  void add() {
    merged_.push_back(added_.front());
    listener_.added(added_.front());
    added_ = added_.subspan(1);
  }
  bool isRemoved(Key128 key) {
    while (!removed_.empty() && removed_.front() < key) removed_ = removed_.subspan(1);
    return !removed_.empty() && removed_.front() == key;
  }

  std::span<const Key128> added_, removed_;  ///< those that are left
  const IndexDraft::Listener& listener_;
  std::vector<Key128> merged_;
};

}  // namespace

std::span<const QuadKey> IndexDraft::page(std::size_t number) const {
  return {keysOf(pages_[number]), lmdb_page::entryCount(pages_[number])};
}

/// After the pages that are there.
void IndexDraft::addPage(std::span<const Key128> keys) {
  std::uint8_t* const page = memory_.take();
  std::transform(keys.begin(), keys.end(), keysOf(page), toKey);
  setCount(page, keys.size());
  pages_.push_back(page);
  first_.push_back(keys.front());
  size_ += keys.size();
}

void IndexDraft::append(Key128 key) {
  const std::size_t count = pages_.empty() ? kMaxKeys : page(pages_.size() - 1).size();
  if (count == kMaxKeys) return addPage(std::span(&key, 1));
  keysOf(pages_.back())[count] = toKey(key);
  setCount(pages_.back(), count + 1);
  ++size_;
}

void IndexDraft::change(std::span<const Key128> added, std::span<const Key128> removed, const Listener& listener) {
  const std::vector<std::uint8_t*> before = std::exchange(pages_, {});
  const std::vector<Key128> first = std::exchange(first_, {});
  pages_.reserve(before.size()), first_.reserve(before.size());
  PageMerge changes(added, removed, listener);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const std::span<const QuadKey> keys{keysOf(before[i]), lmdb_page::entryCount(before[i])};
    const Key128 beyond = i + 1 < before.size() ? first[i + 1] : toNumber(keys.back()) + 1;
    if (!changes.hasBefore(beyond)) {
      pages_.push_back(before[i]);
      first_.push_back(first[i]);
      continue;
    }
    size_ -= keys.size();
    const std::span<const Key128> merged = changes.merge(keys, beyond);
    memory_.giveBack(before[i]);
    const std::size_t pages = (merged.size() + kMaxKeys - 1) / kMaxKeys;
    for (std::size_t part = 0; part < pages; ++part) {
      const std::size_t from = merged.size() * part / pages, to = merged.size() * (part + 1) / pages;
      addPage(merged.subspan(from, to - from));
    }
  }
  constexpr std::size_t kTogether = 4096;
  for (auto rest = changes.rest(); !rest.empty(); rest = rest.subspan(std::min(kTogether, rest.size()))) {
    const auto some = rest.first(std::min(kTogether, rest.size()));
    for (const Key128 key : some) {
      append(key);
      listener.added(key);
    }
    listener.has_merged(some.size());
  }
}

PageDirectory IndexDraft::directory() const {
  std::vector<const QuadKey*> pages;
  pages.reserve(pages_.size());
  for (std::uint8_t* const page : pages_) pages.push_back(keysOf(page));
  return PageDirectory(std::move(pages), first_);
}

}  // namespace cluxel::rdf
