// SPDX-License-Identifier: Apache-2.0
// The state behind a quad cursor: a place in a page directory, and the range it may run through.
#pragma once

#include "knowledge/quad_reader_impl.hpp"

namespace cluxel {

struct QuadCursor::Impl {
  Impl(const PageDirectory& directory, const IndexPattern& pattern, QuadOrder order);

  const PageDirectory& directory;
  IndexPattern pattern;
  QuadOrder order;
  PageDirectory::Position position;
  const QuadKey* at = nullptr;  ///< the rest of the current page's keys within the range
  const QuadKey* stop = nullptr;

  bool loadPage();  ///< false at the end
  void moveTo(Key128 key);
  template <QuadOrder kOrder>
  std::size_t copy(std::span<QuadIds> out);
};

}  // namespace cluxel
