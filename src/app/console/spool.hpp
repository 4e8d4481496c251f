// SPDX-License-Identifier: Apache-2.0
// Writes an answer to stdout: directly, or through a temporary file.
#pragma once

#include <cstdio>
#include <memory>
#include <string_view>

namespace cluxel::app {

/// With a deadline an answer is kept in a temporary file until it is complete, so that nothing of it is printed when
/// the time runs out.
class Spool {
 public:
  explicit Spool(bool keeps_back);
  void write(std::string_view piece);
  /// Prints what was kept back. Throws Error (StoreUnavailable) when the temporary file cannot be written or read.
  void finish();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> kept_;
};

}  // namespace cluxel::app
