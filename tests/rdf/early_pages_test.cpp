// SPDX-License-Identifier: Apache-2.0
// Tests of pages that a long transaction writes to the file before its commit.
#include <fstream>
#include <map>
#include <random>
#include <vector>

#include "rdf/file/map_check.hpp"
#include "rdf/map_file_fixture.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {
namespace {

using Bytes = std::map<std::string, std::string>;

Bytes blocksOf(const ReadTransaction& transaction) {
  Bytes blocks;
  transaction.forEachBlock("t", "", [&](std::string_view key, std::string_view bytes) { blocks.emplace(key, bytes); });
  return blocks;
}

std::uint64_t quadsOf(const ReadTransaction& transaction) {
  return QuadReader(transaction).size();
}

/// Puts, replaces and erases blocks of a few bytes up to a hundred kilobytes, adds quads, and writes pages in between.
class LongTransaction {
 public:
  LongTransaction(WriteTransaction& transaction, Bytes blocks, std::uint64_t seed)
      : transaction_(transaction), blocks_(std::move(blocks)), random_(seed) {}

  void run() {
    QuadWriter writer(transaction_);
    for (int step = 0; step < 300; ++step) {
      change();
      const Term subject = Term::iri("http://example.org/" + std::to_string(random_()));
      writer.add(Quad{subject, Term::iri("http://example.org/p"), Term::literal(std::to_string(step)), {}});
      if (random_() % 8 == 0) writer.flush();
      if (random_() % 8 == 0) transaction_.writePages();
      const bool is_looked_at = random_() % 32 == 0;
      EXPECT_TRUE(!is_looked_at || blocksOf(transaction_) == blocks_) << "step " << step;
    }
    writer.flush();
  }
  const Bytes& blocks() const { return blocks_; }

 private:
  void change() {
    const std::string key = std::to_string(random_() % 60);
    if (random_() % 4 == 0) {
      EXPECT_EQ(transaction_.eraseBlock("t", key), blocks_.erase(key) == 1);
      return;
    }
    const std::size_t size = random_() % 2 == 0 ? random_() % 200 : random_() % 100'000;
    const std::string bytes(size, static_cast<char>('a' + random_() % 26));
    transaction_.putBlock("t", key, bytes);
    blocks_[key] = bytes;
  }

  WriteTransaction& transaction_;
  Bytes blocks_;
  std::mt19937_64 random_;
};

TEST_F(MapFile, HoldsWhatALongTransactionWroteEarly) {
  const auto environment = create();
  Bytes blocks;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    WriteTransaction transaction = environment->write();
    const ReadTransaction before = environment->read();
    LongTransaction changes(transaction, blocks, seed);
    changes.run();
    EXPECT_TRUE(blocksOf(before) == blocks) << "a reader saw pages before the commit, with seed " << seed;
    EXPECT_EQ(quadsOf(before), 300 * (seed - 1));
    transaction.commit();
    blocks = changes.blocks();
    EXPECT_TRUE(blocksOf(environment->read()) == blocks) << seed;
    EXPECT_EQ(quadsOf(environment->read()), 300 * seed);
    EXPECT_TRUE(checkMap(file_).sound()) << seed;
  }
}

TEST_F(MapFile, ReadsIndexesAfterTheirPagesWereWrittenEarly) {
  const auto environment = create();
  const auto quadOf = [](int number) {
    const std::string text = std::to_string(number);
    return Quad{Term::iri("http://example.org/s" + text), Term::iri("http://example.org/p"), Term::literal(text), {}};
  };
  constexpr int kStored = 60'000, kAdded = 300;
  {
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    for (int number = 0; number < kStored; ++number) writer.add(quadOf(number));
    writer.flush();
    transaction.commit();
  }
  WriteTransaction transaction = environment->write();
  for (int round = 0; round < 4; ++round) {
    const int first = kStored + round * kAdded;
    QuadWriter writer(transaction);
    for (int number = first; number < first + kAdded; ++number) writer.add(quadOf(number));
    writer.flush();
    transaction.writePages();
    for (int block = 0; block < 200; ++block)  // they take the memory of pages that were written
      transaction.putBlock("t", std::to_string(block), std::string(round % 2 == 0 ? 1500 : 9000, 'x'));
    const QuadReader reader(static_cast<const ReadTransaction&>(transaction));
    ASSERT_EQ(reader.size(), static_cast<std::uint64_t>(first + kAdded));
    QuadWriter other(transaction);
    for (int number = 7; number < first + kAdded; number += 7) {
      const Quad quad = quadOf(number);
      const auto subject = reader.idOf(quad.subject), object = reader.idOf(quad.object);
      ASSERT_TRUE(subject && object) << "quad " << number << " in round " << round;
      ASSERT_EQ(other.intern(quad.subject), *subject) << number;
      QuadCursor cursor = reader.scan({.s = subject, .p = {}, .o = object, .g = {}});
      QuadIds found;
      ASSERT_TRUE(cursor.next(found)) << number;
    }
  }
  transaction.commit();
  EXPECT_TRUE(checkMap(file_).sound());
}

TEST_F(MapFile, ForgetsWhatATransactionWroteEarlyAndDidNotCommit) {
  const auto environment = create();
  put(*environment, "a", "1");
  const auto length = std::filesystem::file_size(file_);
  {
    WriteTransaction transaction = environment->write();
    transaction.putBlock("t", "a", "2");
    transaction.putBlock("t", "b", std::string(5'000'000, 'x'));
    transaction.writePages();
    EXPECT_GT(std::filesystem::file_size(file_), length) << "nothing was written early";
  }
  EXPECT_EQ(std::filesystem::file_size(file_), length);
  EXPECT_TRUE(blocksOf(environment->read()) == (Bytes{{"a", "1"}}));
  EXPECT_TRUE(checkMap(file_).sound());
}

std::uint64_t anonymousMegabytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (std::uint64_t kilobytes = 0; word == "RssAnon:" && status >> kilobytes) return kilobytes / 1000;
  return 0;
}

TEST_F(MapFile, KeepsFewPagesOfALongTransactionInMemory) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers keep freed memory";
#endif
  const auto environment = create();
  WriteTransaction transaction = environment->write();
  const std::uint64_t before = anonymousMegabytes();
  for (int block = 0; block < 300; ++block)
    transaction.putBlock("t", std::to_string(block), std::string(1'000'000, 'x'));
  EXPECT_LT(anonymousMegabytes(), before + 150) << "LMDB keeps 300 MB of long blocks";
  EXPECT_EQ(transaction.block("t", "7"), std::string(1'000'000, 'x'));
}

}  // namespace
}  // namespace cluxel::rdf
