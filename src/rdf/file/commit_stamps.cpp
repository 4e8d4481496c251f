// SPDX-License-Identifier: Apache-2.0
// A stamp is a block with the number of a commit.
#include "rdf/file/commit_stamps.hpp"

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace cluxel::rdf {

namespace {

constexpr std::string_view kStampTable = "commit stamps";
constexpr std::uint64_t kNoCommit = 0;

void putStamp(WriteTransaction& transaction, std::string_view name, std::uint64_t commit) {
  transaction.putBlock(kStampTable, name, {reinterpret_cast<const char*>(&commit), sizeof commit});
}

}  // namespace

void stampCommit(WriteTransaction& transaction, std::string_view name) {
  putStamp(transaction, name, transaction.commitNumber() + 1);
}

bool hasStamp(const ReadTransaction& transaction, std::string_view name) {
  const auto stored = transaction.block(kStampTable, name);
  std::uint64_t commit = kNoCommit;
  if (!stored || stored->size() != sizeof commit) return false;
  std::memcpy(&commit, stored->data(), sizeof commit);
  return commit == transaction.commitNumber() || commit == transaction.commitNumber() + 1;
}

void carryStamps(const ReadTransaction& from, WriteTransaction& to) {
  from.forEachBlock(kStampTable, {}, [&](std::string_view name, std::string_view) {
    if (hasStamp(from, name))
      stampCommit(to, name);
    else
      putStamp(to, name, kNoCommit);
  });
}

}  // namespace cluxel::rdf
