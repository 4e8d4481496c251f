// SPDX-License-Identifier: Apache-2.0
// Raptor's error messages as diagnostics of the text they are about.
#pragma once

#include <string>
#include <vector>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/knowledge/rdf_io.hpp"

namespace cluxel {

/// Collects messages; the first of a line counts, the others follow from it.
class RdfFaults {
 public:
  explicit RdfFaults(const RdfSource& source) : source_(source) {}
  /// `line` and `column` from 1, 0 when raptor does not say.
  void add(std::size_t line, std::size_t column, std::string_view message);
  void throwIfAny() const;

 private:
  const RdfSource& source_;
  std::vector<Diagnostic> diagnostics_;
  std::string without_place_;  ///< a message that the next one gives the place for
};

}  // namespace cluxel
