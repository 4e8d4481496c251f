// SPDX-License-Identifier: Apache-2.0
// Hashes what a commit says of itself.
#include "rdf/file/check/commit_name.hpp"

#include "base/content_hash.hpp"
#include "rdf/file/check/store_sums.hpp"

namespace cluxel::rdf {

std::string commitName(const ReadTransaction& transaction) {
  const std::uint64_t commit = transaction.commitNumber();
  ContentHasher hasher;
  hasher.add(commit);
  if (const auto sums = storedSums(transaction.impl(), commit))
    for (const EntrySum& sum : {sums->quads, sums->term_hashes}) hasher.add(sum.count).add(sum.hash);
  return hasher.finish().hex();
}

}  // namespace cluxel::rdf
