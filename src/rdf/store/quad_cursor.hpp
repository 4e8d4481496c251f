// SPDX-License-Identifier: Apache-2.0
// The state of a quad cursor: its position in a page directory and its key range.
#pragma once

#include "rdf/store/quad_reader_impl.hpp"

namespace cluxel::rdf {

struct QuadCursor::Impl {
  Impl(const PageDirectory& directory, const IndexPattern& pattern, QuadOrder order);
  /// Over collected keys of an index: all that match the bound prefix of the pattern.
  Impl(std::shared_ptr<const std::vector<QuadKey>> keys, const IndexPattern& pattern, QuadOrder order);

  std::shared_ptr<const std::vector<QuadKey>> collected;
  PageDirectory none;  ///< of collected keys
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

}  // namespace cluxel::rdf
