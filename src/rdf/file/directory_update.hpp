// SPDX-License-Identifier: Apache-2.0
// Brings the list of an index's pages up to date after keys changed, without a look at the pages that did not.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "rdf/file/page_directory.hpp"

namespace cluxel::rdf {

struct UpdatedDirectory {
  PageDirectory directory;
  std::uint64_t dirty_pages = 0;  ///< those that lie outside of the committed pages
};

/// `before`: the directory before the keys `changed` (ascending) were added to or removed from the index. `committed`:
/// the pages of the commit from which the write transaction began; LMDB copies a page before it changes it, so those
/// that are still in use are unchanged. `cursor` is on the index. Absent where all has to be listed anew. Cost: a step
/// per page that the transaction wrote next to a changed key, and a copy of the list.
std::optional<UpdatedDirectory> updatedDirectory(const PageDirectory& before, std::span<const Key128> changed,
                                                 const PageMap& committed, MDB_cursor* cursor);

}  // namespace cluxel::rdf
