// SPDX-License-Identifier: Apache-2.0
// All pages that a change writes lie side by side around its keys: single puts and removals touch the page of the key
// and its neighbours. So the pages from a changed key to the next committed page on both sides are listed anew.
#include "rdf/file/directory_update.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace cluxel::rdf {

namespace {

class DirectoryUpdate {
 public:
  DirectoryUpdate(const PageDirectory& before, const PageMap& committed, MDB_cursor* cursor)
      : before_(before), committed_(committed), cursor_(cursor) {
    pages_.reserve(before.pageCount() + 16);
    lower_.reserve(before.pageCount() + 16);
  }

  std::optional<UpdatedDirectory> run(std::span<const Key128> changed) {
    // The only page of a small index may lie within another page.
    if (before_.pageCount() < 2 || committed_.base == nullptr) return std::nullopt;
    for (const Key128 key : changed) {
      if (next_ == before_.pageCount()) break;
      if (last_of_right_ && key <= *last_of_right_) continue;
      if (!listAround(key)) return std::nullopt;
    }
    keepUntil(before_.pageCount());
    if (pages_.size() < 2) return std::nullopt;
    UpdatedDirectory updated;
    updated.dirty_pages = static_cast<std::uint64_t>(
        std::count_if(pages_.begin(), pages_.end(), [&](const QuadKey* keys) { return !isCommitted(pageOf(keys)); }));
    updated.directory = PageDirectory(std::move(pages_), std::move(lower_));
    updated.directory.guardBy(before_.guard());
    return updated;
  }

 private:
  bool isCommitted(const std::uint8_t* page) const {
    return page >= committed_.base && page < committed_.base + committed_.page_size * committed_.page_count;
  }
  static const std::uint8_t* pageOf(const QuadKey* keys) {
    return reinterpret_cast<const std::uint8_t*>(keys) - lmdb_page::kHeaderSize;
  }
  static const QuadKey* keysOf(const std::uint8_t* page) {
    return reinterpret_cast<const QuadKey*>(page + lmdb_page::kHeaderSize);
  }
  static Key128 firstKey(const std::uint8_t* page) { return toNumber(*keysOf(page)); }
  /// The page to which the cursor moves, or none.
  const std::uint8_t* moved(MDB_cursor_op operation) {
    MDB_val key{};
    MDB_val keys{};
    if (mdb_cursor_get(cursor_, &key, &keys, operation) != MDB_SUCCESS || keys.mv_data == nullptr) return nullptr;
    return static_cast<const std::uint8_t*>(keys.mv_data) - lmdb_page::kHeaderSize;
  }
  bool moveTo(Key128 number) {
    QuadKey bytes = toKey(number);
    MDB_val key = toVal(kIndexKey);
    MDB_val value{sizeof bytes, bytes.bytes.data()};
    return mdb_cursor_get(cursor_, &key, &value, MDB_GET_BOTH_RANGE) == MDB_SUCCESS;
  }
  /// The page of the first key that is not less than `key`, or the last one; none of an empty index.
  const std::uint8_t* pageAt(Key128 number) {
    if (moveTo(number)) return moved(MDB_GET_MULTIPLE);
    MDB_val key;
    MDB_val last;
    if (mdb_cursor_get(cursor_, &key, &last, MDB_LAST) != MDB_SUCCESS) return nullptr;
    const Key128 last_key = toNumber(*static_cast<const QuadKey*>(last.mv_data));
    // A cursor that was moved to the end gives no page until it has been at the start.
    mdb_cursor_get(cursor_, &key, &last, MDB_FIRST);
    return moveTo(last_key) ? moved(MDB_GET_MULTIPLE) : nullptr;
  }
  /// The place of a committed page in the list of before.
  std::optional<std::size_t> placeOf(const std::uint8_t* page) const {
    const std::size_t place = before_.pageOf(firstKey(page));
    if (before_.uncheckedPage(place).data() != keysOf(page)) return std::nullopt;
    return place;
  }
  void keepUntil(std::size_t end) {
    if (end <= next_) return;
    const auto append = [&](const auto& from, auto& to) {
      const auto kept = from.subspan(next_, end - next_);
      to.insert(to.end(), kept.begin(), kept.end());
    };
    append(before_.pages(), pages_);
    append(before_.lowers(), lower_);
    next_ = end;
  }
  void add(const std::uint8_t* page, Key128 lower) {
    pages_.push_back(keysOf(page));
    lower_.push_back(lower);
  }

  bool listAround(Key128 key) {
    const std::uint8_t* middle = pageAt(key);
    if (middle == nullptr) return false;
    std::vector<const std::uint8_t*> run{middle};
    const std::uint8_t* left = moved(MDB_PREV_MULTIPLE);
    for (; left != nullptr && !isCommitted(left); left = moved(MDB_PREV_MULTIPLE)) run.push_back(left);
    if (left != nullptr) {
      const auto place = placeOf(left);
      if (!place || *place + 1 < next_) return false;
      keepUntil(*place + 1);
    }
    for (auto page = run.rbegin(); page != run.rend(); ++page) add(*page, firstKey(*page));
    if (pageAt(firstKey(middle)) != middle) return false;
    const std::uint8_t* right = moved(MDB_NEXT_MULTIPLE);
    for (; right != nullptr && !isCommitted(right); right = moved(MDB_NEXT_MULTIPLE)) add(right, firstKey(right));
    if (right == nullptr) {
      next_ = before_.pageCount();
      return true;
    }
    const auto place = placeOf(right);
    if (!place || *place < next_) return false;
    add(right, firstKey(right));
    next_ = *place + 1;
    // Keys between it and the first key of the next page may have gone to either.
    last_of_right_ = toNumber(before_.uncheckedPage(*place).back());
    return true;
  }

  const PageDirectory& before_;
  const PageMap& committed_;
  MDB_cursor* cursor_;
  std::vector<const QuadKey*> pages_;
  std::vector<Key128> lower_;
  std::size_t next_ = 0;                 ///< the first page of before that is neither kept nor replaced yet
  std::optional<Key128> last_of_right_;  ///< of the committed page that ended the last run: keys up to it are done with
};

}  // namespace

std::optional<UpdatedDirectory> updatedDirectory(const PageDirectory& before, std::span<const Key128> changed,
                                                 const PageMap& committed, MDB_cursor* cursor) {
  return DirectoryUpdate(before, committed, cursor).run(changed);
}

}  // namespace cluxel::rdf
