// SPDX-License-Identifier: Apache-2.0
// Where the library reports to: it never prints by itself.
#pragma once

#include <cstddef>
#include <string_view>

#include "cluxel/export.hpp"

namespace cluxel {

/// Receives progress and messages. Called from one thread at a time. The default ignores everything.
class CLUXEL_API ProgressSink {
 public:
  virtual ~ProgressSink() = default;
  /// `done` of `total` units of `stage` are finished.
  virtual void progress(std::string_view /*stage*/, std::size_t /*done*/, std::size_t /*total*/) {}
  /// Something a person should know that is not an error.
  virtual void note(std::string_view /*message*/) {}
};

}  // namespace cluxel
