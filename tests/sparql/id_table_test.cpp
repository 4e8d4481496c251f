// SPDX-License-Identifier: Apache-2.0
// The table of term ids beside a map of the standard library.
#include "sparql/exec/id_table.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace cluxel::sparql {
namespace {

/// Few hashes, so that many ids share one, and runs of entries wrap around the end of the array.
TEST(IdTable, FindsWhatAMapFindsAfterAnyInsertionsAndErasures) {
  std::mt19937 random(5);
  for (const std::size_t hashes : {3U, 50U, 100'000U}) {
    IdTable table;
    std::map<ValueId, std::size_t> hash_of_id;
    for (int step = 0; step < 20'000; ++step) {
      const ValueId id = 1 + random() % 300;
      const std::size_t hash = std::hash<std::size_t>()(id * 7919U % hashes);
      const bool is_known = hash_of_id.contains(id);
      ASSERT_EQ(table.find(hash, [&](ValueId found) { return found == id; }), is_known ? id : kUnbound)
          << "step " << step << " with " << hashes << " hashes";
      if (is_known) {
        table.erase(hash, id);
        hash_of_id.erase(id);
      } else {
        table.insert(hash, id);
        hash_of_id.emplace(id, hash);
      }
    }
    for (const auto& [id, hash] : hash_of_id)
      EXPECT_EQ(table.find(hash, [wanted = id](ValueId found) { return found == wanted; }), id);
  }
}

TEST(IdTable, FindsNothingWhereTheTestRefusesTheIdsOfAHash) {
  IdTable table;
  EXPECT_EQ(table.find(1, [](ValueId) { return true; }), kUnbound);
  table.insert(1, 4);
  table.insert(1, 5);
  EXPECT_EQ(table.find(1, [](ValueId id) { return id == 6; }), kUnbound);
  EXPECT_EQ(table.find(2, [](ValueId) { return true; }), kUnbound);
}

}  // namespace
}  // namespace cluxel::sparql
