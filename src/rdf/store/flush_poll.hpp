// SPDX-License-Identifier: Apache-2.0
// Lets the caller of a large write end it.
#pragma once

#include <functional>

#include "rdf/file/environment.hpp"

namespace cluxel::rdf {

/// While it exists, `poll` is called every few thousand entries that a QuadWriter flushes within the transaction. What
/// it throws ends the flush; the transaction must then be dropped.
class FlushPoll {
 public:
  FlushPoll(const ReadTransaction& transaction, std::function<void()> poll);
  ~FlushPoll();
  FlushPoll(const FlushPoll&) = delete;
  FlushPoll& operator=(const FlushPoll&) = delete;

 private:
  ReadTransaction transaction_;  ///< shares it
};

}  // namespace cluxel::rdf
