// SPDX-License-Identifier: Apache-2.0
// The directories of a write transaction follow its changes, and list what a look at all pages lists.
#include "rdf/store/indexes/index_directories.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "rdf/file/environment.hpp"
#include "rdf/store/quad_reader_impl.hpp"

namespace cluxel::rdf {
namespace {

void expectAsListedAnew(WriteTransaction& transaction) {
  ReadTransaction::Impl& state = transaction.impl();
  for (const QuadOrder order : kQuadOrders) {
    if (state.draftOf(tableOf(order)) != nullptr) continue;  // that is tested in index_draft_test.cpp
    MDB_cursor* raw = nullptr;
    ASSERT_EQ(mdb_cursor_open(state.live(), state.table(tableOf(order)), &raw), MDB_SUCCESS);
    const CursorHandle cursor(raw);
    const PageDirectory anew(raw);
    const auto followed = state.directories->of(tableOf(order), state);
    ASSERT_EQ(followed->pageCount(), anew.pageCount());
    for (std::size_t page = 0; page < anew.pageCount(); ++page) {
      ASSERT_EQ(followed->page(page).data(), anew.page(page).data()) << page;
      ASSERT_TRUE(followed->lower(page) <= toNumber(anew.page(page).front()));
      if (page > 0) {
        ASSERT_TRUE(followed->lower(page) > toNumber(anew.page(page - 1).back()));
      }
    }
  }
}

/// Quads that lie together in some orders and far apart in others.
QuadIds quadOf(std::uint32_t number) {
  return {number / 4 + 1, number % 7 + 1, number * 2654435761U % 100'003 + 1, number % 3 + 1};
}

class DirectoriesOfIndexes : public testing::Test {
 protected:
  static constexpr std::uint32_t kQuads = 60'000;

  void SetUp() override {
    environment_ = Environment::temporary();
    WriteTransaction transaction = environment_->write();
    QuadWriter writer(transaction);
    for (std::uint32_t number = 0; number < kQuads; ++number) writer.add(quadOf(number));
    writer.flush();
    transaction.commit();
  }

  /// Adds or removes quads of a stretch, most or few of them.
  void change(WriteTransaction& transaction) {
    QuadWriter writer(transaction);
    const std::uint32_t length = 1 + random_() % (random_() % 2 == 0 ? 30 : 3000), first = random_() % (2 * kQuads);
    const bool is_added = random_() % 5 < 2;
    const unsigned one_in = 1 + random_() % 3;
    for (std::uint32_t number = first; number < first + length; ++number) {
      if (random_() % one_in != 0) continue;
      if (is_added)
        writer.add(quadOf(number));
      else
        writer.remove(quadOf(number));
    }
    writer.flush();
  }

  std::mt19937 random_{11};
  std::shared_ptr<Environment> environment_;
};

TEST_F(DirectoriesOfIndexes, FollowChangesOfSeveralTransactions) {
  for (int round = 0; round < 12; ++round) {
    WriteTransaction transaction = environment_->write();
    for (int i = 0; i < 25; ++i) {
      change(transaction);
      if (random_() % 4 == 0) transaction.putBlock("some", std::to_string(i), std::string(random_() % 9000, 'x'));
      ASSERT_NO_FATAL_FAILURE(expectAsListedAnew(transaction)) << "round " << round << ", change " << i;
    }
    if (round % 3 != 2) transaction.commit();  // every third is rolled back
  }
}

/// LMDB keeps the bound of a page whose first keys were removed, so that they return to it.
TEST_F(DirectoriesOfIndexes, FollowFirstKeysOfPagesThatReturn) {
  WriteTransaction transaction = environment_->write();
  ReadTransaction::Impl& state = transaction.impl();
  const auto pages = state.directories->of(Table::Spog, state);
  for (std::size_t page = 4; page + 1 < pages->pageCount(); page += 7) {
    std::vector<QuadIds> first;
    for (const QuadKey& key : pages->page(page).first(3)) first.push_back(toQuad(key, QuadOrder::Spog));
    const QuadIds nearby = toQuad(pages->page(page - 2).front(), QuadOrder::Spog);
    QuadWriter writer(transaction);
    for (const QuadIds& quad : first) writer.remove(quad);
    writer.flush();
    writer.remove(nearby);  // two pages before, with an unchanged page between
    for (const QuadIds& quad : first) writer.add(quad);
    writer.flush();
    ASSERT_NO_FATAL_FAILURE(expectAsListedAnew(transaction)) << page;
    for (const QuadIds& quad : first) ASSERT_TRUE(QuadReader(transaction).contains(quad)) << page;
  }
}

TEST_F(DirectoriesOfIndexes, FollowRemovalOfNearlyEverything) {
  WriteTransaction transaction = environment_->write();
  QuadWriter writer(transaction);
  for (std::uint32_t first = 0; first < kQuads; first += 600) {  // few enough to be removed singly
    for (std::uint32_t number = first; number < first + 600; ++number)
      if (number % 900 != 0) writer.remove(quadOf(number));
    writer.flush();
    ASSERT_NO_FATAL_FAILURE(expectAsListedAnew(transaction)) << first;
  }
}

TEST_F(DirectoriesOfIndexes, AreKeptWhereNothingOfTheIndexChanges) {
  WriteTransaction transaction = environment_->write();
  ReadTransaction::Impl& state = transaction.impl();
  const auto before = state.directories->of(Table::Spog, state);
  transaction.putBlock("some", "key", "bytes");
  EXPECT_EQ(state.directories->of(Table::Spog, state), before);
  QuadWriter writer(transaction);
  writer.add(quadOf(kQuads));
  writer.flush();
  const auto after = state.directories->of(Table::Spog, state);
  EXPECT_NE(after, before);
  std::size_t same = 0;
  for (std::size_t page = 0; page < before->pageCount(); ++page)
    same += after->page(page).data() == before->page(page).data() ? 1 : 0;
  EXPECT_GE(same, before->pageCount() - 2);
}

TEST_F(DirectoriesOfIndexes, AreMadeAnewWhenLmdbMayMovePages) {
  WriteTransaction transaction = environment_->write();
  ReadTransaction::Impl& state = transaction.impl();
  change(transaction);
  const auto before = state.directories->of(Table::Spog, state);
  for (int i = 0; i < 20'000; ++i) transaction.putBlock("some", std::to_string(i), "bytes");
  EXPECT_NE(state.directories->of(Table::Spog, state), before);
  change(transaction);
  expectAsListedAnew(transaction);
}

}  // namespace
}  // namespace cluxel::rdf
