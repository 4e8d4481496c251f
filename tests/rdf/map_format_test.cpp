// SPDX-License-Identifier: Apache-2.0
// Tests of maps of earlier and newer formats.
#include <lmdb.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstring>
#include <fstream>

#include "base/file_bytes.hpp"
#include "rdf/file/map_check.hpp"
#include "rdf/map_file_fixture.hpp"
#include "rdf/store/quad_reader_impl.hpp"

namespace cluxel::rdf {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

/// Opens the file with LMDB directly, to write what the library would not write.
template <typename Work>
void withLmdb(const fs::path& file, const Work& work) {
  MDB_env* environment = nullptr;
  MDB_txn* transaction = nullptr;
  MDB_dbi main = 0;
  ASSERT_EQ(mdb_env_create(&environment), 0);
  ASSERT_EQ(mdb_env_set_maxdbs(environment, 8), 0);
  ASSERT_EQ(mdb_env_open(environment, file.c_str(), MDB_NOSUBDIR, 0666), 0);
  ASSERT_EQ(mdb_txn_begin(environment, nullptr, 0, &transaction), 0);
  ASSERT_EQ(mdb_dbi_open(transaction, nullptr, 0, &main), 0);
  work(transaction, main);
  ASSERT_EQ(mdb_txn_commit(transaction), 0);
  mdb_env_close(environment);
}

void putText(MDB_txn* transaction, MDB_dbi table, std::string key, std::string value) {
  MDB_val stored_key{key.size(), key.data()};
  MDB_val stored_value{value.size(), value.data()};
  ASSERT_EQ(mdb_put(transaction, table, &stored_key, &stored_value, 0), 0);
}

TEST_F(MapFile, RefusesANewerFormatAndForeignLmdbFiles) {
  withLmdb(file_, [](MDB_txn* transaction, MDB_dbi main) { putText(transaction, main, "other", "x"); });
  EXPECT_THAT(refusal(), HasSubstr("not a Cluxel map"));
  fs::remove(file_);
  create().reset();
  withLmdb(file_, [](MDB_txn* transaction, MDB_dbi main) { putText(transaction, main, "cluxel-format", "7"); });
  EXPECT_THAT(refusal(), HasSubstr("newer format (7; this program reads 6)"));
}

std::size_t entriesOf(MDB_txn* transaction, const char* table) {
  MDB_dbi opened = 0;
  MDB_stat stat{};
  EXPECT_EQ(mdb_dbi_open(transaction, table, MDB_DUPSORT | MDB_DUPFIXED, &opened), 0);
  EXPECT_EQ(mdb_stat(transaction, opened, &stat), 0);
  return stat.ms_entries;
}

/// Puts the first `size` bytes of the sums anew, as those of this transaction.
void putSums(MDB_txn* transaction, MDB_dbi main, std::size_t size) {
  MDB_val key{11, const_cast<char*>("cluxel-sums")}, value;
  ASSERT_EQ(mdb_get(transaction, main, &key, &value), 0);
  std::string sums(static_cast<const char*>(value.mv_data), size);
  const std::uint64_t commit = mdb_txn_id(transaction);
  std::memcpy(sums.data(), &commit, sizeof commit);
  const std::uint64_t checksum = XXH3_64bits(sums.data(), sums.size());
  putText(transaction, main, "cluxel-sums",
          sums + std::string(reinterpret_cast<const char*>(&checksum), sizeof checksum));
}

/// The keys of an index.
std::vector<std::string> keysOf(MDB_txn* transaction, const char* index) {
  MDB_dbi table = 0;
  EXPECT_EQ(mdb_dbi_open(transaction, index, MDB_DUPSORT | MDB_DUPFIXED, &table), 0);
  MDB_cursor* cursor = nullptr;
  EXPECT_EQ(mdb_cursor_open(transaction, table, &cursor), 0);
  std::vector<std::string> keys;
  MDB_val name, value;
  while (mdb_cursor_get(cursor, &name, &value, MDB_NEXT) == 0)
    keys.emplace_back(static_cast<const char*>(value.mv_data), value.mv_size);
  mdb_cursor_close(cursor);
  return keys;
}

void putKey(MDB_txn* transaction, const char* index, std::string key) {
  MDB_dbi table = 0;
  ASSERT_EQ(mdb_dbi_open(transaction, index, MDB_DUPSORT | MDB_DUPFIXED, &table), 0);
  MDB_val name{1, const_cast<char*>("q")}, stored{key.size(), key.data()};
  ASSERT_EQ(mdb_put(transaction, table, &name, &stored, 0), 0);
}

void remove(MDB_txn* transaction, MDB_dbi table, std::string name) {
  MDB_val key{name.size(), name.data()};
  ASSERT_EQ(mdb_del(transaction, table, &key, nullptr), 0) << name;
}

constexpr std::size_t kSumsOfFifthFormat = 56, kSumsOfThirdFormat = 40;

/// Gives posg the sums of ranges that it had in the fifth format, which had no psog.
void useRangesOfFifthFormat(Environment& environment) {
  WriteTransaction transaction = environment.write();
  std::vector<QuadKey> keys;
  QuadCursor quads = QuadReader(transaction).scan({}, QuadOrder::Posg);
  for (QuadIds quad; quads.next(quad);) keys.push_back(toKey(toNumber(quad, QuadOrder::Posg)));
  RangeSummer sums(Table::Posg);
  sums.add(keys);
  storeRanges(transaction, Table::Posg, sums.take());
  transaction.eraseBlock("index sums", "psog");
  transaction.commit();
}

/// Undoes what the sixth format changed: moves quads with numbers from psog to posg. It follows the function above.
void makeFifthFormat(MDB_txn* transaction, MDB_dbi main) {
  putText(transaction, main, "cluxel-format", "5");
  for (const std::string& key : keysOf(transaction, "psog"))
    putKey(transaction, "posg", key.substr(0, 4) + key.substr(8, 4) + key.substr(4, 4) + key.substr(12));
  MDB_dbi psog = 0;
  ASSERT_EQ(mdb_dbi_open(transaction, "psog", MDB_DUPSORT | MDB_DUPFIXED, &psog), 0);
  ASSERT_EQ(mdb_drop(transaction, psog, 1), 0);
  putSums(transaction, main, kSumsOfFifthFormat);
}

/// Undoes also what the fifth format added: the sums of ranges.
void makeFourthFormat(MDB_txn* transaction, MDB_dbi main) {
  makeFifthFormat(transaction, main);
  putText(transaction, main, "cluxel-format", "4");
  MDB_dbi blocks = 0;
  ASSERT_EQ(mdb_dbi_open(transaction, "blocks", 0, &blocks), 0);
  remove(transaction, main, "cluxel-keys:index sums");
  for (const char* index : {"hashes", "spog", "posg", "ospg", "gspo"})
    remove(transaction, blocks, std::string("index sums") + '\0' + index);
}

/// Undoes what the fourth format changed: adds literals to the index by object, whose sum the record lacks.
void makeThirdFormat(MDB_txn* transaction, MDB_dbi main) {
  makeFourthFormat(transaction, main);
  putText(transaction, main, "cluxel-format", "3");
  for (const std::string& key : keysOf(transaction, "spog"))
    putKey(transaction, "ospg", key.substr(8, 4) + key.substr(0, 8) + key.substr(12));
  putSums(transaction, main, kSumsOfThirdFormat);
}

/// Removes what the second format added: the sums of quads and terms.
void makeFirstFormat(MDB_txn* transaction, MDB_dbi main) {
  makeThirdFormat(transaction, main);
  putText(transaction, main, "cluxel-format", "1");
  MDB_dbi blocks = 0;
  ASSERT_EQ(mdb_dbi_open(transaction, "blocks", 0, &blocks), 0);
  remove(transaction, main, "cluxel-sums");
  remove(transaction, main, "cluxel-keys:term sums");
  remove(transaction, blocks, std::string("term sums") + std::string(5, '\0'));
}

/// Quads with integers, and as many with an IRI.
void addNumbers(Environment& environment, int first, int last) {
  WriteTransaction transaction = environment.write();
  QuadWriter writer(transaction);
  for (int i = first; i < last; ++i) {
    const Term subject = Term::iri("s" + std::to_string(i));
    writer.add({subject, Term::iri("p"), Term::integer(i % 50), Term::iri("")});
    writer.add({subject, Term::iri("q"), Term::iri("o"), Term::iri("")});
  }
  writer.flush();
  transaction.commit();
}

std::uint64_t countOf(const Environment& environment, const Term& object) {
  const QuadReader reader(environment.read());
  return reader.count({.s = {}, .p = {}, .o = reader.idOf(object), .g = {}});
}

TEST_F(MapFile, KeepsLiteralsOutOfTheIndexByObjectAndNumbersInOneOfTheirOwn) {
  addNumbers(*create(), 0, 500);
  withLmdb(file_, [](MDB_txn* transaction, MDB_dbi) {
    EXPECT_EQ(entriesOf(transaction, "ospg"), 500U);
    EXPECT_EQ(entriesOf(transaction, "posg"), 500U);
    EXPECT_EQ(entriesOf(transaction, "psog"), 500U);
    EXPECT_EQ(entriesOf(transaction, "spog"), 1000U);
  });
  EXPECT_EQ(countOf(*open(OpenMode::ReadOnly), Term::integer(7)), 10U);
  EXPECT_EQ(countOf(*open(OpenMode::ReadOnly), Term::iri("o")), 500U);
}

/// A map that another format was made of stays sound through changes. Returns its compacted copy.
class MapOfEarlierFormat : public MapFile {
 protected:
  template <typename Make>
  fs::path compactedAfterChange(std::uint32_t quads, const Make& make) {
    addNumbers(*create(), 0, quads);
    useRangesOfFifthFormat(*open());
    withLmdb(file_, make);
    EXPECT_THAT(checkMap(file_).faults, ElementsAre());
    addNumbers(*open(), quads, quads + 100);
    EXPECT_THAT(checkMap(file_).faults, ElementsAre());
    EXPECT_EQ(countOf(*open(OpenMode::ReadOnly), Term::integer(7)), quads / 50 + 2);
    const fs::path compacted = folder_.path() / "compacted.clx";
    open(OpenMode::ReadOnly)->compactTo(compacted);
    EXPECT_THAT(checkMap(compacted).faults, ElementsAre());
    return compacted;
  }
};

TEST_F(MapOfEarlierFormat, TheThirdKeepsLiteralsInTheIndexByObject) {
  for (const fs::path& file : {compactedAfterChange(500, makeThirdFormat), file_})
    withLmdb(file, [](MDB_txn* transaction, MDB_dbi) { EXPECT_EQ(entriesOf(transaction, "ospg"), 1200U); });
}

TEST_F(MapOfEarlierFormat, TheFifthKeepsNumbersInTheIndexByValue) {
  for (const fs::path& file : {compactedAfterChange(5000, makeFifthFormat), file_})
    withLmdb(file, [](MDB_txn* transaction, MDB_dbi) {
      EXPECT_EQ(entriesOf(transaction, "posg"), 10'200U);
      MDB_dbi psog = 0;
      EXPECT_EQ(mdb_dbi_open(transaction, "psog", 0, &psog), MDB_NOTFOUND);
    });
}

TEST_F(MapOfEarlierFormat, TheFourthIsComparedAsAWhole) {
  compactedAfterChange(5000, makeFourthFormat);
  std::string bytes = readFile(file_);
  const std::size_t at = bytes.find("s4321");
  ASSERT_NE(at, std::string::npos);
  bytes[at] = 'S';
  std::ofstream(file_, std::ios::binary) << bytes;
  EXPECT_THROW(open()->write(), Error) << "a writer compares all";
}

TEST_F(MapFile, OfTheFirstFormatIsReadAndGetsSumsWithItsNextCommit) {
  addNumbers(*create(), 0, 500);
  useRangesOfFifthFormat(*open());
  withLmdb(file_, makeFirstFormat);
  EXPECT_EQ(QuadReader(open(OpenMode::ReadOnly)->read()).size(), 1000U);
  EXPECT_TRUE(checkMap(file_).sound());
  const fs::path compacted = folder_.path() / "compacted.clx";
  open(OpenMode::ReadOnly)->compactTo(compacted);
  EXPECT_TRUE(checkMap(compacted).sound());
  addNumbers(*open(), 500, 600);
  EXPECT_TRUE(checkMap(file_).sound());
  withLmdb(file_, [](MDB_txn* transaction, MDB_dbi main) {
    MDB_val key{11, const_cast<char*>("cluxel-sums")};
    ASSERT_EQ(mdb_del(transaction, main, &key, nullptr), 0);
  });
  EXPECT_THROW(QuadReader(open(OpenMode::ReadOnly)->read()).size(), Error) << "no longer of the first format";
}

}  // namespace
}  // namespace cluxel::rdf
