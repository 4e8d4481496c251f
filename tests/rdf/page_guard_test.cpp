// SPDX-License-Identifier: Apache-2.0
// Sums of ranges follow an index, and who reads a damaged range is told, while others read and write the rest.
#include "rdf/file/check/page_guard.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <random>
#include <thread>

#include "base/file_bytes.hpp"
#include "rdf/file/map_check.hpp"
#include "rdf/map_file_fixture.hpp"
#include "rdf/store/quad_reader_impl.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {
namespace {

constexpr TermId kTerms = 100'003;

QuadIds quadOf(std::uint32_t number) {
  return {number / 4 + 1, number % 7 + 1, number * 2654435761U % kTerms + 1, number % 3 + 1};
}

bool hasNumber(const QuadIds& quad) {
  return quad.o % 2 == 0;
}

/// Even ids are numbers.
void addTerms(QuadWriter& writer) {
  ASSERT_EQ(writer.intern(Term::iri(vocabulary::xsd("integer"))), 1U);
  for (TermId id = 2; id <= kTerms + 1; ++id)
    ASSERT_EQ(writer.intern(hasNumber({.o = id}) ? Term::integer(id) : Term::iri("t" + std::to_string(id))), id);
}

/// Each range has the sum of its keys, none is too long, and together they are the whole.
void expectSumsOfRanges(Environment& environment) {
  const ReadTransaction transaction = environment.read();
  for (const Table index : kIndexTables) {
    const RangeSums stored = storedRanges(transaction.impl(), index);
    std::vector<RangeSums::Range> counted(stored.ranges().begin(), stored.ranges().end());
    for (RangeSums::Range& range : counted) range.sum = {};
    const PageDirectory& pages = snapshotOf(transaction.impl()).directory(index, transaction.impl());
    for (std::size_t page = 0; page < pages.pageCount(); ++page)
      for (const QuadKey& key : pages.page(page))
        counted[stored.rangeOf(toNumber(key))].sum.add(keyInSumOf(index, toNumber(key)));
    for (std::size_t range = 0; range < counted.size(); ++range) {
      ASSERT_EQ(counted[range].sum, stored.ranges()[range].sum) << static_cast<int>(index) << ", range " << range;
      ASSERT_LE(counted[range].sum.count, RangeSums::kMaxKeys);
    }
    ASSERT_EQ(stored.whole(), sumOf(pages, index, "map"));
  }
}

class GuardedMap : public MapFile {
 protected:
  static constexpr std::uint32_t kQuads = 150'000;

  void SetUp() override {
    const auto environment = create();
    {
      WriteTransaction transaction = environment->write();
      QuadWriter writer(transaction);
      addTerms(writer);
      writer.flush();
      transaction.commit();
    }
    add(*environment, 0, kQuads);
  }

  static void add(Environment& environment, std::uint32_t first, std::uint32_t last) {
    WriteTransaction transaction = environment.write();
    QuadWriter writer(transaction);
    for (std::uint32_t number = first; number < last; ++number) writer.add(quadOf(number));
    writer.flush();
    transaction.commit();
  }

  /// Changes the third id of a quad in an index, on the page of the current commit.
  void damage(std::uint32_t number, QuadOrder order = QuadOrder::Spog) {
    std::size_t at = 0;
    {
      const ReadTransaction transaction = open(OpenMode::ReadOnly)->read();
      StoreSnapshot& snapshot = snapshotOf(transaction.impl());
      const PageDirectory& pages = snapshot.directory(tableOf(order), transaction.impl());
      const auto place = pages.lowerBound(toNumber(quadOf(number), order));
      at = reinterpret_cast<std::uintptr_t>(&pages.page(place.page)[place.index]) -
           reinterpret_cast<std::uintptr_t>(snapshot.map().base);
    }
    std::fstream file(file_, std::ios::binary | std::ios::in | std::ios::out);
    file.seekg(static_cast<std::streamoff>(at + 11));  // its last byte
    const auto byte = static_cast<char>(file.get() ^ 1);
    file.seekp(static_cast<std::streamoff>(at + 11));
    file.put(byte);
  }

  static std::size_t quadsOf(const Environment& environment, std::uint32_t subject) {
    QuadCursor quads = QuadReader(environment.read()).scan({.s = subject, .p = {}, .o = {}, .g = {}}, QuadOrder::Spog);
    std::size_t count = 0;
    for (QuadIds quad; quads.next(quad);) ++count;
    return count;
  }
};

TEST_F(GuardedMap, KeepsTheSumsOfRangesThroughChangesOfAllSizes) {
  const auto environment = open();
  ASSERT_NO_FATAL_FAILURE(expectSumsOfRanges(*environment));
  std::mt19937 random(5);
  for (int round = 0; round < 25; ++round) {
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    const std::uint32_t length = random() % (round % 5 == 0 ? 90'000 : 6'000), first = random() % kQuads;
    const bool is_added = random() % 2 == 0;
    for (std::uint32_t number = first; number < first + length; ++number) {
      if (is_added)
        writer.add(quadOf(number));
      else
        writer.remove(quadOf(number));
      if (random() % 2000 == 0) writer.flush();
    }
    writer.flush();
    if (round % 4 == 3) continue;  // is rolled back
    transaction.commit();
    ASSERT_NO_FATAL_FAILURE(expectSumsOfRanges(*environment)) << "round " << round;
  }
  ASSERT_NO_FATAL_FAILURE(expectSumsOfRanges(*environment));
  const std::filesystem::path compacted = folder_.path() / "compacted.clx";
  environment->compactTo(compacted);
  ASSERT_NO_FATAL_FAILURE(expectSumsOfRanges(*Environment::open(compacted, OpenMode::ReadWrite)));
}

TEST_F(GuardedMap, TellsADamagedRangeFromWholeOnes) {
  damage(kQuads / 2);
  const auto environment = open(OpenMode::ReadOnly);
  EXPECT_THROW(quadsOf(*environment, kQuads / 2 / 4 + 1), Error);
  EXPECT_THROW(quadsOf(*environment, kQuads / 2 / 4 + 2), Error) << "nearby";
  EXPECT_EQ(quadsOf(*environment, 1), 4U);
  EXPECT_EQ(quadsOf(*environment, kQuads / 4 - 10), 4U);
  EXPECT_EQ(QuadReader(environment->read()).size(), kQuads);
  EXPECT_FALSE(checkMap(file_).sound());
}

TEST_F(GuardedMap, IsComparedBySeveralReadersAtOnce) {
  damage(kQuads / 2);
  const auto environment = open(OpenMode::ReadOnly);
  std::atomic<std::size_t> found{0}, refused{0};
  std::vector<std::thread> readers;
  for (std::uint32_t reader = 0; reader < 4; ++reader)
    readers.emplace_back([&, reader] {
      for (std::uint32_t i = 0; i < 40; ++i) {
        const std::uint32_t subject = (i * 7919 + reader * 104'729) % (kQuads / 4) + 1;
        try {
          found += quadsOf(*environment, subject);
        } catch (const Error&) {
          ++refused;
        }
      }
    });
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(found + 4 * refused, 4U * 40 * 4);
  EXPECT_GT(refused, 0U) << "some asked for the damaged range";
  EXPECT_GT(found, 300U);
}

TEST_F(GuardedMap, KeepsWhatIsKnownOfADamageThroughCommitsBesideIt) {
  damage(kQuads / 2);
  {
    const auto environment = open();
    for (std::uint32_t i = 0; i < 4; ++i) add(*environment, kQuads + i * 500, kQuads + i * 500 + 500);
    EXPECT_EQ(quadsOf(*environment, (kQuads + 300) / 4 + 1), 4U);
    EXPECT_THROW(quadsOf(*environment, kQuads / 2 / 4 + 1), Error) << "this process did not write it";
  }
  const auto environment = open();
  EXPECT_EQ(quadsOf(*environment, (kQuads + 300) / 4 + 1), 4U);
  EXPECT_THROW(quadsOf(*environment, kQuads / 2 / 4 + 1), Error);
  EXPECT_THROW(environment->compactTo(folder_.path() / "compacted.clx"), Error) << "a copy would hold it";
}

/// LMDB splits and joins pages near a damage: what it moves stays known as damaged.
TEST_F(GuardedMap, KeepsWhatIsKnownOfADamageThroughChangesAroundIt) {
  damage(kQuads / 2);
  for (int round = 0; round < 2; ++round) {
    const auto environment = open();
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    for (std::uint32_t number = kQuads / 2 - 2000; number < kQuads / 2 + 2000; ++number) {
      if (number == kQuads / 2 || number % 8 == 0) continue;
      if (round == 0)
        writer.remove(quadOf(number));
      else
        writer.add(quadOf(number));
    }
    writer.flush();
    const QuadReader within(transaction);
    EXPECT_THROW(
        {
          QuadCursor quads = within.scan({.s = kQuads / 2 / 4 + 1, .p = {}, .o = {}, .g = {}}, QuadOrder::Spog);
          for (QuadIds quad; quads.next(quad);) continue;
        },
        Error)
        << "in the transaction that wrote the page, round " << round;
    transaction.commit();
    EXPECT_THROW(quadsOf(*environment, kQuads / 2 / 4 + 1), Error) << "after its commit, round " << round;
  }
  EXPECT_THROW(quadsOf(*open(OpenMode::ReadOnly), kQuads / 2 / 4 + 1), Error);
  EXPECT_FALSE(checkMap(file_).sound());
}

/// LMDB gives back as many pages as the first page of a long value states.
TEST_F(MapFile, RefusesToWriteOverALongBlockWithADamagedHead) {
  const std::string text(20'000, 'x');
  {
    const auto environment = create();
    WriteTransaction transaction = environment->write();
    for (const char* key : {"a", "b"}) transaction.putBlock("long", key, key + text);
    transaction.commit();
  }
  const std::string whole = readFile(file_);
  const std::size_t value = whole.find("b" + text);
  ASSERT_NE(value, std::string::npos);
  const std::size_t head = value - value % 4096;
  for (const std::size_t byte : {0U, 10U, 12U, 14U}) {  // of the number, the flags and the number of pages
    std::string damaged = whole;
    damaged[head + byte] = static_cast<char>(damaged[head + byte] ^ 0x11);
    std::ofstream(file_, std::ios::binary) << damaged;
    const auto environment = open();
    WriteTransaction transaction = environment->write();
    EXPECT_THROW(transaction.putBlock("long", "b", "short"), Error) << byte;
    EXPECT_THROW(transaction.putBlock("long", "b", "c" + text), Error) << byte;
    EXPECT_THROW(transaction.eraseBlock("long", "b"), Error) << byte;
    transaction.putBlock("long", "a", "short");
    EXPECT_TRUE(transaction.eraseBlock("long", "a")) << "written by this transaction";
    transaction.commit();
    EXPECT_EQ(environment->read().block("long", "b"), "b" + text) << byte;
    EXPECT_FALSE(checkMap(file_).sound()) << byte;
  }
}

struct DamagedChange {
  QuadOrder order;
  bool has_number, is_added;
};

std::vector<DamagedChange> damagedChanges() {
  std::vector<DamagedChange> changes;
  for (const QuadOrder order : kQuadOrders)
    for (const bool has_number : {false, true}) {
      const bool is_lacking =
          has_number ? order == QuadOrder::Posg || order == QuadOrder::Ospg : order == QuadOrder::Psog;
      if (is_lacking) continue;
      for (const bool is_added : {true, false}) changes.push_back({order, has_number, is_added});
    }
  return changes;
}

/// A damaged index lacks the quad that the others have, so that it cannot follow. The index by object has a sum of its
/// own: there the damage stays known.
TEST_F(GuardedMap, LosesNothingByAChangeOfADamagedQuad) {
  const std::string whole = readFile(file_);
  for (const auto& [order, has_number, is_added] : damagedChanges()) {
    std::uint32_t number = kQuads / 2;
    while (hasNumber(quadOf(number)) != has_number) ++number;
    std::ofstream(file_, std::ios::binary) << whole;
    damage(number, order);
    const auto change = [&, adds = is_added] {
      const auto environment = open();
      WriteTransaction transaction = environment->write();
      QuadWriter writer(transaction);
      if (adds)
        writer.add(quadOf(number));
      else
        writer.remove(quadOf(number));
      writer.flush();
      transaction.commit();
    };
    const std::string which = std::to_string(static_cast<int>(order)) + (has_number ? ", a number" : "") +
                              (is_added ? ", added" : ", removed");
    if (order == QuadOrder::Ospg)
      EXPECT_NO_THROW(change()) << which;
    else
      EXPECT_THROW(change(), Error) << which;
    EXPECT_EQ(quadsOf(*open(OpenMode::ReadOnly), 1), 4U) << which;
    EXPECT_FALSE(checkMap(file_).sound()) << which;
  }
}

TEST_F(GuardedMap, RefusesToWriteBesideAMalformedPage) {
  std::size_t at = 0;
  {
    const ReadTransaction transaction = open(OpenMode::ReadOnly)->read();
    StoreSnapshot& snapshot = snapshotOf(transaction.impl());
    const PageDirectory& pages = snapshot.directory(Table::Spog, transaction.impl());
    const auto place = pages.lowerBound(toNumber(quadOf(kQuads / 2), QuadOrder::Spog));
    at = reinterpret_cast<std::uintptr_t>(pages.page(place.page).data()) -
         reinterpret_cast<std::uintptr_t>(snapshot.map().base) - lmdb_page::kHeaderSize;
  }
  const std::string bytes = readFile(file_);
  for (const std::size_t byte : {0U, 8U, 10U, 12U, 14U}) {  // of the number, the key size, the flags and the bounds
    std::string damaged = bytes;
    damaged[at + byte] = static_cast<char>(damaged[at + byte] ^ 0x44);
    std::ofstream(file_, std::ios::binary) << damaged;
    EXPECT_THROW(add(*open(), kQuads / 2 - 40, kQuads / 2 + 40), Error) << byte;
    EXPECT_NO_THROW(add(*open(), kQuads, kQuads + 40)) << byte;
    EXPECT_FALSE(checkMap(file_).sound()) << byte;
  }
}

TEST(RangeSums, JoinShortRanges) {
  const auto range = [](std::uint32_t first, std::uint64_t count) {
    return RangeSums::Range{Key128{first}, EntrySum{count, first}};
  };
  RangeSums sums({range(0, 16384), range(1, 100), range(2, 3 * 8192), range(3, 20'000), range(4, 8'000), range(5, 50)});
  const EntrySum whole = sums.whole();
  EXPECT_FALSE(sums.hasLong());
  sums.joinShort();
  ASSERT_EQ(sums.ranges().size(), 4U);
  EXPECT_EQ(sums.ranges()[0].sum.count, 16484U);
  EXPECT_EQ(sums.ranges()[3].sum.count, 8'050U);
  EXPECT_TRUE(sums.ranges()[3].first == Key128{4});
  EXPECT_EQ(sums.whole(), whole);
}

TEST(RangeSums, AreReadAsTheyWereWritten) {
  RangeSummer summer(Table::Posg);
  std::vector<Key128> keys;
  for (std::uint32_t i = 1; i < 100'000; ++i) keys.push_back((Key128{i % 3} << 96U) + (Key128{i} << 64U) + i);
  std::sort(keys.begin(), keys.end());
  std::vector<QuadKey> stored(keys.size());
  std::transform(keys.begin(), keys.end(), stored.begin(), toKey);
  summer.add(stored);
  const RangeSums made = summer.take();
  EXPECT_EQ(made.ranges().size(), (keys.size() + RangeSums::kUsualKeys - 1) / RangeSums::kUsualKeys);
  const RangeSums read = RangeSums::fromBytes(made.bytes(), "map");
  ASSERT_EQ(read.ranges().size(), made.ranges().size());
  for (std::size_t i = 0; i < read.ranges().size(); ++i) {
    EXPECT_TRUE(read.ranges()[i].first == made.ranges()[i].first);
    EXPECT_EQ(read.ranges()[i].sum, made.ranges()[i].sum);
  }
  EXPECT_THROW(RangeSums::fromBytes(made.bytes().substr(1), "map"), Error);
  EXPECT_THROW(RangeSums::fromBytes("", "map"), Error);
  EXPECT_THROW(RangeSums::fromBytes(made.bytes() + std::string(32, '\0'), "map"), Error);
}

}  // namespace
}  // namespace cluxel::rdf
