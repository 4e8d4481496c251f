// SPDX-License-Identifier: Apache-2.0
// A block that is gone, or that no search finds, is an error and not an absent block.
#include <fstream>
#include <random>

#include "base/file_bytes.hpp"
#include "rdf/file/lmdb_environment.hpp"
#include "rdf/file/map_check.hpp"
#include "rdf/map_file_fixture.hpp"

namespace cluxel::rdf {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class BlockKeySums : public MapFile {
 protected:
  static constexpr int kCount = 300;

  void fill() {
    const auto environment = create();
    WriteTransaction transaction = environment->write();
    for (int i = 0; i < kCount; ++i) transaction.putBlock("scans", nameOf(i), "value " + std::to_string(i));
    transaction.putBlock("other", "one", "1");
    transaction.commit();
  }
  static std::string nameOf(int i) { return "name-" + std::to_string(1000 + i); }

  /// Replaces a text in the last place of the file where it stands; it must stand there.
  void replace(const std::string& text, const std::string& by) {
    std::string bytes = readFile(file_);
    const std::size_t at = bytes.rfind(text);
    ASSERT_NE(at, std::string::npos);
    bytes.replace(at, by.size(), by);
    std::ofstream(file_, std::ios::binary) << bytes;
  }

  /// The message of a reading of all blocks, or their number.
  std::string visit() {
    int count = 0;
    try {
      open(OpenMode::ReadOnly)->read().forEachBlock("scans", "", [&](std::string_view, std::string_view) { ++count; });
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::StoreUnavailable);
      return error.what();
    }
    return std::to_string(count);
  }
};

TEST_F(BlockKeySums, FollowEveryChange) {
  fill();
  EXPECT_EQ(visit(), std::to_string(kCount));
  {
    const auto environment = open();
    WriteTransaction transaction = environment->write();
    transaction.putBlock("scans", nameOf(3), "another value");
    transaction.putBlock("scans", "new", "value");
    EXPECT_TRUE(transaction.eraseBlock("scans", nameOf(7)));
    EXPECT_TRUE(transaction.eraseBlock("scans", nameOf(8)));
    EXPECT_FALSE(transaction.eraseBlock("scans", nameOf(8)));
    transaction.commit();
  }
  EXPECT_EQ(visit(), std::to_string(kCount - 1));
  const fs::path compacted = folder_.path() / "compacted.clx";
  open(OpenMode::ReadOnly)->compactTo(compacted);
  fs::rename(compacted, file_);
  EXPECT_EQ(visit(), std::to_string(kCount - 1));
  EXPECT_TRUE(checkMap(file_).sound());
}

TEST_F(BlockKeySums, FindABlockWhoseKeyLeftTheTable) {
  fill();
  const std::string zero(1, '\0');
  replace("scans" + zero + nameOf(kCount - 1), "scant");
  EXPECT_THAT(visit(), HasSubstr("keys of the blocks 'scans' are damaged (300 were written, 299 are there)"));
  EXPECT_FALSE(checkMap(file_).sound());
}

TEST_F(BlockKeySums, FindAKeyThatIsOutOfOrder) {
  fill();
  replace(nameOf(120), "name-9");
  EXPECT_THAT(visit(), HasSubstr("keys of the blocks 'scans' are damaged"));
  EXPECT_THROW(open(OpenMode::ReadOnly)->read().block("scans", nameOf(120)), Error) << "a block that is not found";
  EXPECT_EQ(open(OpenMode::ReadOnly)->read().block("other", "one"), "1") << "another table is as it was";
}

/// What each commit makes of the sums is what the file then holds.
TEST_F(BlockKeySums, AreKnownWithoutReadingTheKeysAgain) {
  fill();
  const auto environment = open();
  std::mt19937 random(3);
  for (int round = 0; round < 20; ++round) {
    WriteTransaction transaction = environment->write();
    for (int i = 0; i < 30; ++i) {
      const std::string table = random() % 3 == 0 ? "other" : "scans", name = nameOf(static_cast<int>(random() % 600));
      if (random() % 2 == 0)
        transaction.putBlock(table, name, "new");
      else
        transaction.eraseBlock(table, name);
    }
    if (round % 5 == 4) continue;  // is rolled back
    transaction.commit();
    const ReadTransaction now = environment->read();
    const ReadTransaction::Impl& state = now.impl();
    for (const std::string table : {"scans", "other", "no table"}) {
      KeySum there;
      now.forEachBlock(table, "", [&](std::string_view key, std::string_view) {
        there.add(table + std::string(1, '\0') + std::string(key));
      });
      EXPECT_EQ(state.environment->presentKeys(state.commitBefore(), table), there) << round << table;
    }
  }
}

TEST_F(BlockKeySums, DoNotHideThatABlockWasNeverThere) {
  fill();
  EXPECT_EQ(open(OpenMode::ReadOnly)->read().block("scans", "never"), std::nullopt);
  EXPECT_EQ(open(OpenMode::ReadOnly)->read().block("no table", "never"), std::nullopt);
}

}  // namespace
}  // namespace cluxel::rdf
