// SPDX-License-Identifier: Apache-2.0
// What copies of an answer share.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "cluxel/answer.hpp"
#include "sparql/results/result_table.hpp"

namespace cluxel {

struct Answer::Data {
  sparql::QueryResult result;
  std::vector<Diagnostic> warnings;

  static Answer answer(Data data) { return Answer(std::make_shared<const Data>(std::move(data))); }
};

}  // namespace cluxel
