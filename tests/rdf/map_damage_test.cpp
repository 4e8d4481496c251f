// SPDX-License-Identifier: Apache-2.0
// Tests of files that are not maps, and of damaged maps.
#include <cstddef>
#include <cstring>
#include <fstream>
#include <random>

#include "base/file_bytes.hpp"
#include "rdf/file/lmdb_page.hpp"
#include "rdf/file/map_check.hpp"
#include "rdf/map_file_fixture.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

TEST_F(MapFile, RefusesWhatIsNoMapInPlainWords) {
  EXPECT_THAT(refusal(), HasSubstr("no such file"));
  std::ofstream(file_).close();
  for (const OpenMode mode : {OpenMode::ReadOnly, OpenMode::ReadWrite})
    EXPECT_THAT(refusal(mode), HasSubstr("is empty, a map was expected"));
  EXPECT_EQ(fs::file_size(file_), 0U) << "a refusal leaves the file as it is";
  std::ofstream(file_) << std::string(100'000, 'x');
  EXPECT_THAT(refusal(), HasSubstr("not a Cluxel map"));
  std::ofstream(file_) << "short";
  EXPECT_THAT(refusal(), HasSubstr("not a Cluxel map"));
  fs::remove(file_);
  fs::create_directory(file_);
  EXPECT_THAT(refusal(), HasSubstr("folder"));
}

std::size_t countOf(QuadCursor quads) {
  std::size_t count = 0;
  for (QuadIds quad; quads.next(quad);) ++count;
  return count;
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

/// LMDB may leave such a page when the disk refuses the meta page of a new commit.
TEST_F(MapFile, IsThatOfItsNewestCommitWhateverRootsTheOtherMetaPageNames) {
  put(*create(), "a", "first");
  put(*open(), "a", "second");
  std::string bytes = readFile(file_);
  const auto transactionAt = [&](std::size_t page) {
    lmdb_page::Meta meta;
    std::memcpy(&meta, bytes.data() + page * 4096 + lmdb_page::kHeaderSize, sizeof meta);
    return meta.transaction;
  };
  const std::size_t older = transactionAt(0) < transactionAt(1) ? 0 : 1;
  for (const std::size_t page : {older, 1 - older}) {
    std::string changed = bytes;
    const std::uint64_t root = 1'000'000;
    std::memcpy(changed.data() + page * 4096 + lmdb_page::kHeaderSize + offsetof(lmdb_page::Meta, main) +
                    offsetof(lmdb_page::Tree, root),
                &root, sizeof root);
    std::ofstream(file_, std::ios::binary) << changed;
    if (page == older)
      EXPECT_EQ(open(OpenMode::ReadOnly)->read().block("t", "a"), "second");
    else
      EXPECT_THAT(refusal(), HasSubstr("damaged"));
  }
}

TEST_F(MapFile, IsNotOpenedWithALockFileThatLeadsElsewhere) {
  put(*create(), "a", "first");
  const fs::path other = folder_.path() / "other.txt", lock = file_.string() + "-lock";
  std::ofstream(other) << "important";
  fs::remove(lock);
  fs::create_symlink(other, lock);
  EXPECT_THAT(refusal(OpenMode::ReadWrite), HasSubstr("is a symbolic link"));
  EXPECT_EQ(open(OpenMode::ReadOnly)->read().block("t", "a"), "first") << "of a private copy";
  EXPECT_EQ(readFile(other), "important");
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
  EXPECT_EQ(sound.blocks, 2U + 6);           // with one of the sums of terms, and those of the indexes
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
