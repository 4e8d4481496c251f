// SPDX-License-Identifier: Apache-2.0
// Pages split in the middle when a key does not fit; appended ones are full.
#include "rdf/store/indexes/index_draft.hpp"

#include <algorithm>
#include <cstring>

namespace cluxel::rdf {

void IndexDraft::Page::setSize(std::size_t count) {
  const auto lower = static_cast<std::uint16_t>(lmdb_page::kHeaderSize + 2 * count);
  std::memcpy(bytes.data() + offsetof(lmdb_page::Header, lower), &lower, sizeof lower);
}

void IndexDraft::addPage(std::size_t before) {
  auto page = std::make_unique_for_overwrite<Page>();
  page->setSize(0);
  pages_.insert(pages_.begin() + static_cast<std::ptrdiff_t>(before), std::move(page));
  first_.insert(first_.begin() + static_cast<std::ptrdiff_t>(before), Key128{0});
}

void IndexDraft::append(Key128 key) {
  if (pages_.empty() || pages_.back()->size() == Page::kMaxKeys) {
    addPage(pages_.size());
    first_.back() = key;
  }
  Page& page = *pages_.back();
  const std::size_t count = page.size();
  page.first()[count] = toKey(key);
  page.setSize(count + 1);
  ++size_;
}

/// Where the key is, or where it would be inserted. Expects a page.
IndexDraft::Place IndexDraft::placeOf(Key128 key) const {
  const auto beyond = std::upper_bound(first_.begin(), first_.end(), key);
  const auto page = static_cast<std::size_t>(beyond - first_.begin()) - (beyond == first_.begin() ? 0 : 1);
  const std::span<const QuadKey> keys = pages_[page]->keys();
  const auto found =
      std::partition_point(keys.begin(), keys.end(), [key](const QuadKey& entry) { return toNumber(entry) < key; });
  return {page, static_cast<std::size_t>(found - keys.begin()), found != keys.end() && toNumber(*found) == key};
}

void IndexDraft::split(std::size_t number) {
  addPage(number + 1);
  Page &left = *pages_[number], &right = *pages_[number + 1];
  const std::size_t kept = left.size() / 2, moved = left.size() - kept;
  std::copy_n(left.first() + kept, moved, right.first());
  left.setSize(kept);
  right.setSize(moved);
  first_[number + 1] = toNumber(*right.first());
}

bool IndexDraft::insert(Key128 key) {
  if (pages_.empty()) {
    append(key);
    return true;
  }
  Place place = placeOf(key);
  if (place.is_there) return false;
  if (pages_[place.page]->size() == Page::kMaxKeys) {
    split(place.page);
    place = placeOf(key);
  }
  Page& page = *pages_[place.page];
  const std::size_t count = page.size();
  std::copy_backward(page.first() + place.index, page.first() + count, page.first() + count + 1);
  page.first()[place.index] = toKey(key);
  page.setSize(count + 1);
  first_[place.page] = toNumber(*page.first());
  ++size_;
  return true;
}

bool IndexDraft::remove(Key128 key) {
  if (pages_.empty()) return false;
  const Place place = placeOf(key);
  if (!place.is_there) return false;
  Page& page = *pages_[place.page];
  const std::size_t count = page.size();
  std::copy(page.first() + place.index + 1, page.first() + count, page.first() + place.index);
  page.setSize(count - 1);
  --size_;
  if (count > 1) {
    first_[place.page] = toNumber(*page.first());
    return true;
  }
  pages_.erase(pages_.begin() + static_cast<std::ptrdiff_t>(place.page));
  first_.erase(first_.begin() + static_cast<std::ptrdiff_t>(place.page));
  return true;
}

PageDirectory IndexDraft::directory() const {
  std::vector<const QuadKey*> pages;
  pages.reserve(pages_.size());
  for (const std::unique_ptr<Page>& page : pages_) pages.push_back(page->first());
  return PageDirectory(std::move(pages), first_);
}

}  // namespace cluxel::rdf
