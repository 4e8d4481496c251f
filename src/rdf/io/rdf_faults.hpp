// SPDX-License-Identifier: Apache-2.0
// Collects raptor's error messages as diagnostics.
#pragma once

#include <string>
#include <vector>

#include "cluxel/error.hpp"
#include "rdf/io/rdf_io.hpp"

namespace cluxel::rdf {

/// Keeps the first message of each line; later ones are usually consequences of it.
class RdfFaults {
 public:
  explicit RdfFaults(const RdfSource& source) : source_(source) {}
  /// `line` and `column` start at 1; 0 when raptor does not report them.
  void add(std::size_t line, std::size_t column, std::string_view message);
  void throwIfAny() const;

 private:
  const RdfSource& source_;
  std::vector<Diagnostic> diagnostics_;
  std::string without_place_;  ///< a message whose location comes with the next one
};

}  // namespace cluxel::rdf
