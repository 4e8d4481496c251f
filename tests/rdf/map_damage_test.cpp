// SPDX-License-Identifier: Apache-2.0
// Tests of files that are not maps, of maps of newer formats, and of damaged maps.
#include <lmdb.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstring>
#include <fstream>
#include <random>

#include "base/file_bytes.hpp"
#include "rdf/file/map_check.hpp"
#include "rdf/map_file_fixture.hpp"
#include "rdf/store/quad_store.hpp"

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

TEST_F(MapFile, RefusesWhatIsNoMapInPlainWords) {
  EXPECT_THAT(refusal(), HasSubstr("no such file"));
  std::ofstream(file_).close();
  EXPECT_THAT(refusal(), HasSubstr("is empty"));
  std::ofstream(file_) << std::string(100'000, 'x');
  EXPECT_THAT(refusal(), HasSubstr("not a Cluxel map"));
  std::ofstream(file_) << "short";
  EXPECT_THAT(refusal(), HasSubstr("not a Cluxel map"));
  fs::remove(file_);
  fs::create_directory(file_);
  EXPECT_THAT(refusal(), HasSubstr("folder"));
}

TEST_F(MapFile, RefusesANewerFormatAndForeignLmdbFiles) {
  withLmdb(file_, [](MDB_txn* transaction, MDB_dbi main) { putText(transaction, main, "other", "x"); });
  EXPECT_THAT(refusal(), HasSubstr("not a Cluxel map"));
  fs::remove(file_);
  create().reset();
  withLmdb(file_, [](MDB_txn* transaction, MDB_dbi main) { putText(transaction, main, "cluxel-format", "6"); });
  EXPECT_THAT(refusal(), HasSubstr("newer format (6; this program reads 5)"));
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

/// Undoes what the fifth format added: the sums of ranges.
void makeFourthFormat(MDB_txn* transaction, MDB_dbi main) {
  putText(transaction, main, "cluxel-format", "4");
  MDB_dbi blocks = 0;
  ASSERT_EQ(mdb_dbi_open(transaction, "blocks", 0, &blocks), 0);
  const auto remove = [&](MDB_dbi table, std::string name) {
    MDB_val key{name.size(), name.data()};
    ASSERT_EQ(mdb_del(transaction, table, &key, nullptr), 0) << name;
  };
  remove(main, "cluxel-keys:index sums");
  for (const char* index : {"hashes", "spog", "posg", "ospg", "gspo"})
    remove(blocks, std::string("index sums") + '\0' + index);
  putSums(transaction, main, 56);
}

/// Undoes what the fourth format changed: adds literals to the index by object, whose sum the record lacks.
void makeThirdFormat(MDB_txn* transaction, MDB_dbi main) {
  makeFourthFormat(transaction, main);
  putText(transaction, main, "cluxel-format", "3");
  MDB_dbi spog = 0, ospg = 0;
  ASSERT_EQ(mdb_dbi_open(transaction, "spog", MDB_DUPSORT | MDB_DUPFIXED, &spog), 0);
  ASSERT_EQ(mdb_dbi_open(transaction, "ospg", MDB_DUPSORT | MDB_DUPFIXED, &ospg), 0);
  MDB_cursor* quads = nullptr;
  ASSERT_EQ(mdb_cursor_open(transaction, spog, &quads), 0);
  std::vector<std::string> keys;
  MDB_val name, value;
  while (mdb_cursor_get(quads, &name, &value, MDB_NEXT) == 0) {
    const std::string_view key(static_cast<const char*>(value.mv_data), value.mv_size);
    keys.push_back(std::string(key.substr(8, 4)) + std::string(key.substr(0, 8)) + std::string(key.substr(12)));
  }
  mdb_cursor_close(quads);
  for (std::string& key : keys) {
    MDB_val stored_name{1, const_cast<char*>("q")}, stored{key.size(), key.data()};
    ASSERT_EQ(mdb_put(transaction, ospg, &stored_name, &stored, 0), 0);
  }
  putSums(transaction, main, 40);
}

/// Removes what the second format added: the sums of quads and terms.
void makeFirstFormat(MDB_txn* transaction, MDB_dbi main) {
  makeThirdFormat(transaction, main);
  putText(transaction, main, "cluxel-format", "1");
  MDB_dbi blocks = 0;
  ASSERT_EQ(mdb_dbi_open(transaction, "blocks", 0, &blocks), 0);
  const std::string of_terms = std::string("term sums") + std::string(5, '\0');
  for (const auto& [table, name] :
       {std::pair(main, std::string("cluxel-sums")), std::pair(main, std::string("cluxel-keys:term sums")),
        std::pair(blocks, of_terms)}) {
    MDB_val key{name.size(), const_cast<char*>(name.data())};
    ASSERT_EQ(mdb_del(transaction, table, &key, nullptr), 0) << name;
  }
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

std::size_t countOf(QuadCursor quads) {
  std::size_t count = 0;
  for (QuadIds quad; quads.next(quad);) ++count;
  return count;
}

TEST_F(MapFile, KeepsLiteralsOutOfTheIndexByObject) {
  addNumbers(*create(), 0, 500);
  withLmdb(file_, [](MDB_txn* transaction, MDB_dbi) {
    EXPECT_EQ(entriesOf(transaction, "ospg"), 500U);
    EXPECT_EQ(entriesOf(transaction, "posg"), 1000U);
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

TEST_F(MapOfEarlierFormat, TheFourthIsComparedAsAWhole) {
  compactedAfterChange(5000, [](MDB_txn* transaction, MDB_dbi main) { makeFourthFormat(transaction, main); });
  std::string bytes = readFile(file_);
  const std::size_t at = bytes.find("s4321");
  ASSERT_NE(at, std::string::npos);
  bytes[at] = 'S';
  std::ofstream(file_, std::ios::binary) << bytes;
  EXPECT_THROW(open()->write(), Error) << "a writer compares all";
}

TEST_F(MapFile, OfTheFirstFormatIsReadAndGetsSumsWithItsNextCommit) {
  addNumbers(*create(), 0, 500);
  withLmdb(file_, [](MDB_txn* transaction, MDB_dbi main) { makeFirstFormat(transaction, main); });
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

TEST_F(MapFile, TellsChangedQuadsAndTermsWhenTheyAreRead) {
  {
    const auto environment = create();
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    for (int i = 0; i < 2'000; ++i)
      writer.add({Term::iri("subject" + std::to_string(i)), Term::iri("p"), Term::integer(i), Term::iri("")});
    writer.flush();
    transaction.commit();
  }
  const std::string bytes = readFile(file_);
  std::string damaged = bytes;
  damaged[damaged.find("subject1500")] = 'S';
  std::ofstream(file_, std::ios::binary) << damaged;
  {
    const QuadReader reader(open(OpenMode::ReadOnly)->read());
    EXPECT_EQ(reader.termOf(1).text, "subject0") << "terms that are whole can be read";
    EXPECT_EQ(reader.size(), 2'000U);
    EXPECT_TRUE(reader.idOf(Term::iri("subject20")).has_value());
    EXPECT_THROW(for (TermId id = 1; id <= reader.termCount(); ++id) reader.termOf(id), Error);
    EXPECT_NO_THROW(open(OpenMode::ReadWrite)->write()) << "a writer verifies what it reads";
  }
  damaged = bytes;
  const std::array<std::uint8_t, 8> quad = {0, 0, 3, 233, 0, 0, 0, 2};  // subject 1001, predicate 2
  const std::size_t at = damaged.find(std::string(reinterpret_cast<const char*>(quad.data()), quad.size()));
  ASSERT_NE(at, std::string::npos);
  damaged[at + 3] = static_cast<char>(234);
  std::ofstream(file_, std::ios::binary) << damaged;
  const QuadReader reader(open(OpenMode::ReadOnly)->read());
  EXPECT_EQ(reader.termOf(1).text, "subject0");
  EXPECT_THROW(countOf(reader.scan({}, QuadOrder::Spog)), Error);
  EXPECT_EQ(countOf(reader.scan({}, QuadOrder::Posg)), 2'000U) << "an index that is whole can be read";
}

TEST_F(MapFile, RefusesAFileThatIsCutShort) {
  {
    const auto environment = create();
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    for (TermId i = 1; i < 20'000; ++i) writer.add(QuadIds{i, 1, i, 0});
    writer.flush();
    transaction.commit();
  }
  const auto size = fs::file_size(file_);
  for (const std::uintmax_t part : {size - 4096, size / 2, std::uintmax_t{20'000}, std::uintmax_t{8192}}) {
    fs::resize_file(file_, part);
    EXPECT_THAT(refusal(), testing::AnyOf(HasSubstr("damaged"), HasSubstr("not a Cluxel map"))) << part;
  }
}

TEST_F(MapFile, IsKnownByItsContentWhateverItsName) {
  EXPECT_FALSE(looksLikeMap(file_)) << "not there";
  EXPECT_FALSE(looksLikeMap(folder_.path())) << "a folder";
  create().reset();
  EXPECT_TRUE(looksLikeMap(file_));
  fs::rename(file_, folder_.path() / "scan.pcd");
  EXPECT_TRUE(looksLikeMap(folder_.path() / "scan.pcd"));
  std::ofstream(file_) << "VERSION .7\nFIELDS x y z\n";
  EXPECT_FALSE(looksLikeMap(file_));
}

TEST_F(MapFile, FindsAChangedByteInABlock) {
  put(*create(), "a", std::string(10'000, 'x'));
  std::string bytes = readFile(file_);
  const std::size_t at = bytes.find(std::string(5'000, 'x'));
  ASSERT_NE(at, std::string::npos);
  bytes[at + 100] = 'y';
  std::ofstream(file_, std::ios::binary) << bytes;
  const auto environment = open(OpenMode::ReadOnly);
  EXPECT_THROW(environment->read().block("t", "a"), Error);
}

TEST_F(MapFile, IsFoundSoundOrDamagedAsAWhole) {
  {
    const auto environment = create();
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    for (int i = 1; i < 3'000; ++i)
      writer.add({Term::iri("s" + std::to_string(i % 700)), Term::iri("p"), Term::integer(i), Term::iri("")});
    writer.flush();
    transaction.putBlock("t", "a", std::string(10'000, 'x'));
    transaction.commit();
  }
  const MapCheck sound = checkMap(file_);
  EXPECT_THAT(sound.faults, ElementsAre());
  EXPECT_EQ(sound.quads, 2'999U);
  EXPECT_EQ(sound.blocks, 2U + 5);           // with one of the sums of terms, and those of the indexes
  EXPECT_EQ(sound.terms, 700U + 2'999 + 2);  // subjects, numbers, the predicate and xsd:integer
  const std::string bytes = readFile(file_);
  std::mt19937 random(11);
  int found = 0;
  for (int i = 0; i < 300; ++i) {
    std::string damaged = bytes;
    const std::size_t at = 8192 + random() % (bytes.size() - 8192);
    damaged[at] = static_cast<char>(damaged[at] ^ (1U << (random() % 8)));
    std::ofstream(file_, std::ios::binary) << damaged;
    try {
      found += checkMap(file_).sound() ? 0 : 1;
    } catch (const Error&) {
      ++found;
    }
  }
  EXPECT_GT(found, 150) << "most bytes of the file are in use";
}

}  // namespace
}  // namespace cluxel::rdf
