// SPDX-License-Identifier: Apache-2.0
// Indexes in memory hold what a set holds, and a transaction reads and writes through them as through the file.
#include "rdf/store/indexes/index_draft.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "rdf/file/map_check.hpp"
#include "rdf/map_file_fixture.hpp"
#include "rdf/scratch_folder.hpp"
#include "rdf/store/indexes/index_orders.hpp"
#include "rdf/store/quad_journal.hpp"
#include "rdf/store/quad_reader_impl.hpp"

namespace cluxel::rdf {
namespace {

std::vector<Key128> keysIn(const PageDirectory& directory) {
  std::vector<Key128> keys;
  for (std::size_t i = 0; i < directory.pageCount(); ++i)
    for (const QuadKey& key : directory.page(i)) keys.push_back(toNumber(key));
  return keys;
}

void expectSame(const IndexDraft& draft, const std::set<Key128>& keys) {
  ASSERT_EQ(draft.size(), keys.size());
  const PageDirectory directory = draft.directory();
  ASSERT_TRUE(keysIn(directory) == std::vector<Key128>(keys.begin(), keys.end()));
  for (Key128 wanted = 0; wanted < 4000; wanted += 7) {
    const PageDirectory::Position found = directory.lowerBound(wanted << 70U);
    const auto expected = keys.lower_bound(wanted << 70U);
    ASSERT_EQ(found.page == directory.pageCount(), expected == keys.end());
    if (expected == keys.end()) continue;
    ASSERT_TRUE(toNumber(directory.page(found.page)[found.index]) == *expected);
  }
}

/// Changes a draft and a set, and compares what the draft tells with what the set did.
void change(IndexDraft& draft, std::set<Key128>& keys, const std::set<Key128>& added, const std::set<Key128>& removed) {
  const std::vector<Key128> to_add(added.begin(), added.end()), to_remove(removed.begin(), removed.end());
  std::vector<Key128> has_added, has_removed, new_keys, old_keys;
  draft.change(to_add, to_remove,
               {[&](Key128 key) { has_added.push_back(key); }, [&](Key128 key) { has_removed.push_back(key); },
                [](std::size_t) {}});
  for (const Key128 key : added)
    if (keys.insert(key).second) new_keys.push_back(key);
  for (const Key128 key : removed)
    if (keys.erase(key) == 1) old_keys.push_back(key);
  EXPECT_TRUE(has_added == new_keys);
  EXPECT_TRUE(has_removed == old_keys);
  expectSame(draft, keys);
}

TEST(IndexDraft, HoldsWhatASetHolds) {
  const ScratchFolder folder;
  std::mt19937 random(5);
  IndexDraft draft(folder.path());
  std::set<Key128> keys;
  for (Key128 key = 0; key < 3000; key += 2) {  // full pages
    draft.append(key << 70U);
    keys.insert(key << 70U);
  }
  expectSame(draft, keys);
  for (const unsigned one_in : {5U, 2U, 1000U})  // it grows, stays, and is emptied
    for (const int count : {1, 3, 700, 10, 2500, 2, 9000}) {
      std::set<Key128> added, removed;
      for (int i = 0; i < count; ++i) (random() % one_in == 0 ? added : removed).insert(Key128{random() % 4000} << 70U);
      for (const Key128 key : added) removed.erase(key);
      change(draft, keys, added, removed);
    }
  change(draft, keys, {}, std::set<Key128>(keys));
  EXPECT_EQ(draft.pageCount(), 0U);
  change(draft, keys, {Key128{7} << 70U}, {Key128{8} << 70U});
}

/// Pages beyond the memory of a draft lie in a file. Those that are written anew are used again.
TEST(IndexDraft, IsLargerThanItsMemory) {
  constexpr std::uint64_t kKeys = 5'000'000;  // 76 MiB
  const ScratchFolder folder;
  IndexDraft draft(folder.path());
  for (std::uint64_t key = 0; key < kKeys; ++key) draft.append(Key128{2 * key});
  const std::size_t bytes = draft.bytes();
  EXPECT_LE(bytes, 80'000'000U + (std::size_t{4} << 20U));
  std::vector<Key128> some;
  for (std::uint64_t key = 0; key < kKeys; key += 100) some.push_back(Key128{2 * key + 1});
  std::uint64_t added = 0, removed = 0;
  const IndexDraft::Listener listener{[&](Key128) { ++added; }, [&](Key128) { ++removed; }, [](std::size_t) {}};
  draft.change(some, {}, listener);
  draft.change({}, some, listener);
  EXPECT_LE(draft.bytes(), 2 * bytes + (std::size_t{4} << 20U));  // each page became two
  EXPECT_EQ(added, some.size());
  EXPECT_EQ(removed, some.size());
  ASSERT_EQ(draft.size(), kKeys);
  std::uint64_t next = 0;
  for (std::size_t i = 0; i < draft.pageCount(); ++i)
    for (const QuadKey& key : draft.page(i)) ASSERT_TRUE(toNumber(key) == Key128{2 * next++});
  EXPECT_EQ(next, kKeys);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));  // the file has no name
}

TEST(IndexOrders, AreThoseOfASort) {
  std::mt19937 random(6);
  for (const TermId ids : {3U, 90U, 1'000'000U}) {  // counted, and compared where ids are sparse
    std::set<QuadIds> quads;
    const auto id = [&] { return static_cast<TermId>(random() % ids); };
    while (quads.size() < std::min<std::size_t>(ids * ids, 3000)) quads.insert({id(), id(), id(), id() % 3});
    const std::vector<QuadIds> sorted(quads.begin(), quads.end());
    for (const QuadOrder order : kQuadOrders) {
      std::vector<Key128> expected;
      for (const QuadIds& quad : quads) expected.push_back(toNumber(quad, order));
      std::sort(expected.begin(), expected.end());
      EXPECT_TRUE(keysOf(sorted, order) == expected);
    }
  }
}

using LargeChanges = MapFile;

/// Changes a store step by step, large and small, and compares all its orders with a set after each.
class Changed {
 public:
  Changed(WriteTransaction& transaction, unsigned seed)
      : writer_(transaction), reader_(static_cast<const ReadTransaction&>(transaction)), random_(seed) {
    for (int i = 0; i < 2000; ++i) terms_.push_back(writer_.intern(Term::integer(i)));
  }
  std::set<QuadIds>& quads() { return quads_; }

  void add(int count) {
    for (int i = 0; i < count; ++i) writer_.add(*quads_.insert(any()).first);
  }
  void removeOneIn(unsigned share) {
    std::erase_if(quads_, [&](const QuadIds& quad) {
      const bool is_removed = random_() % share == 0;
      if (is_removed) writer_.remove(quad);
      return is_removed;
    });
    writer_.remove(any());  // hardly ever there
  }
  void expectSame() {
    writer_.flush();
    ASSERT_EQ(reader_.size(), quads_.size());
    for (const QuadOrder order : kQuadOrders) {
      std::vector<QuadIds> found;
      QuadCursor cursor = reader_.scan({}, order);
      for (QuadIds quad; cursor.next(quad);) found.push_back(quad);
      ASSERT_TRUE(std::is_sorted(found.begin(), found.end(), [order](const QuadIds& a, const QuadIds& b) {
        return toNumber(a, order) < toNumber(b, order);
      }));
      ASSERT_EQ(std::set<QuadIds>(found.begin(), found.end()), quads_);
    }
  }

 private:
  QuadIds any() {
    const auto term = [&](std::size_t of) { return terms_[random_() % of]; };
    return {term(2000), term(5), term(900), term(3)};
  }

  QuadWriter writer_;
  QuadReader reader_;
  std::mt19937 random_;
  std::vector<TermId> terms_;
  std::set<QuadIds> quads_;
};

TEST_F(LargeChanges, AreReadInTheirTransactionAndWrittenWithIt) {
  std::map<unsigned, std::set<QuadIds>> written;
  for (const unsigned threads : {1U, 3U}) {
    const std::filesystem::path file = folder_.path() / (std::to_string(threads) + ".clx");
    {
      const auto environment = Environment::open(file, OpenMode::Create);
      WriteTransaction transaction = environment->write();
      transaction.useThreads(threads);
      Changed store(transaction, 8);
      for (const int count : {20'000, 30, 5000, 1}) {
        store.add(count);
        store.expectSame();
        store.removeOneIn(count > 1000 ? 10 : 500);
        store.expectSame();
      }
      const auto changes = changesOf(transaction);
      ASSERT_TRUE(changes.has_value());
      EXPECT_EQ(std::set<QuadIds>(changes->added.begin(), changes->added.end()), store.quads());
      written[threads] = store.quads();
      transaction.commit();
    }
    EXPECT_TRUE(checkMap(file).sound());
    const QuadReader reader(Environment::open(file, OpenMode::ReadOnly)->read());
    EXPECT_EQ(reader.size(), written[threads].size());
    for (const QuadIds& quad : written[threads]) ASSERT_TRUE(reader.contains(quad));
  }
  EXPECT_EQ(written[1], written[3]);
}

/// The folder of a temporary store is gone when its draft needs a file.
TEST_F(LargeChanges, OfTemporaryStoresAreHeldToo) {
  constexpr TermId kSubjects = 1'200'000;
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  QuadWriter writer(transaction);
  const TermId first = writer.intern(Term::iri("p"));
  for (TermId i = 0; i < kSubjects; ++i) writer.add(QuadIds{first + i, first, first, first});
  writer.flush();
  EXPECT_EQ(QuadReader(static_cast<const ReadTransaction&>(transaction)).size(), kSubjects);
  transaction.commit();
  EXPECT_EQ(QuadReader(environment->read()).size(), kSubjects);
}

TEST_F(LargeChanges, AreForgottenWithTheirTransaction) {
  const auto environment = create();
  {
    WriteTransaction transaction = environment->write();
    Changed store(transaction, 9);
    store.add(5000);
    store.expectSame();
  }
  EXPECT_EQ(QuadReader(environment->read()).size(), 0U);
  WriteTransaction transaction = environment->write();
  EXPECT_EQ(QuadReader(static_cast<const ReadTransaction&>(transaction)).size(), 0U);
}

/// A few quads among many split no pages of the file, as they would once it is written.
TEST_F(LargeChanges, AreWrittenInFullPages) {
  const auto sizeAfter = [&](const char* name, bool together) {
    const std::filesystem::path file = folder_.path() / name;
    const auto environment = Environment::open(file, OpenMode::Create);
    std::optional<WriteTransaction> transaction = environment->write();
    for (const int rest : {0, 1}) {
      QuadWriter writer(*transaction);
      for (int i = 0; i < 60'000; ++i)
        if ((i % 40 == 7) == (rest == 1))
          writer.add({Term::integer(i), Term::iri("p"), Term::integer(i % 7), Term::iri("")});
      writer.flush();
      if (together) continue;
      transaction->commit();
      transaction.reset();
      transaction = environment->write();
    }
    transaction->commit();
    return std::filesystem::file_size(file);
  };
  EXPECT_LT(static_cast<double>(sizeAfter("together.clx", true)),
            0.8 * static_cast<double>(sizeAfter("two.clx", false)));
}

}  // namespace
}  // namespace cluxel::rdf
