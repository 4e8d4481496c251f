// SPDX-License-Identifier: Apache-2.0
// What copies of an answer share.
#pragma once

#include <vector>

#include "cluxel/answer.hpp"
#include "sparql/results/result_table.hpp"

namespace cluxel {

struct Answer::Data {
  sparql::QueryResult result;
  std::vector<Diagnostic> warnings;
};

}  // namespace cluxel
