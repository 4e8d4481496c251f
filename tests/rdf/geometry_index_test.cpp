// SPDX-License-Identifier: Apache-2.0
// Tests of the stored spatial index: after any commits it finds what a look at every literal finds.
#include "rdf/store/geometry_index.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <random>

#include "cluxel/error.hpp"
#include "rdf/file/map_check.hpp"
#include "rdf/scratch_folder.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {
namespace {

using testing::HasSubstr;

const std::string kWkt = std::string(vocabulary::kGeo) + "wktLiteral";

struct Point {
  int x = 0, y = 0;
};

/// A map to which random points are added, each with its literal.
class PointMap {
 public:
  explicit PointMap(std::shared_ptr<Environment> environment) : environment_(std::move(environment)) {}

  void add(int count, std::mt19937& random) {
    WriteTransaction transaction = environment_->write();
    QuadWriter writer(transaction);
    for (int i = 0; i < count; ++i) {
      const Point point{static_cast<int>(random() % 1000), static_cast<int>(random() % 1000)};
      const Term literal =
          Term::literal("POINT(" + std::to_string(point.x) + " " + std::to_string(point.y) + ")", kWkt);
      writer.add({Term::iri("http://example.org/" + std::to_string(random())), Term::iri("http://example.org/at"),
                  literal, Term::iri("")});
      points_[literal.text] = point;
    }
    writer.flush();
    transaction.commit();
  }
  void write(const Term& object) {
    WriteTransaction transaction = environment_->write();
    QuadWriter writer(transaction);
    writer.add({Term::iri("http://example.org/o"), Term::iri("http://example.org/at"), object, Term::iri("")});
    writer.flush();
    transaction.commit();
  }
  /// A part of the stored index.
  void putBlock(std::string_view key, std::string_view bytes) {
    WriteTransaction transaction = environment_->write();
    transaction.putBlock("geometries", key, bytes);
    transaction.commit();
  }
  QuadReader reader() const { return QuadReader(environment_->read()); }
  std::vector<TermId> expected(const QuadReader& reader, int from, int to) const {
    std::vector<TermId> ids;
    for (const auto& [text, point] : points_) {
      if (point.x >= from && point.x <= to && point.y >= from && point.y <= to)
        ids.push_back(*reader.idOf(Term::literal(text, kWkt)));
    }
    std::sort(ids.begin(), ids.end());
    return ids;
  }
  const std::map<std::string, Point>& points() const { return points_; }
  Environment& environment() { return *environment_; }

 private:
  std::shared_ptr<Environment> environment_;
  std::map<std::string, Point> points_;
};

FlatBox square(int from, int to) {
  return FlatBox::around(from, from, to, to);
}

TEST(GeometryIndex, FindsWhatALookAtEveryLiteralFindsAfterAnyCommits) {
  std::mt19937 random(7);
  PointMap map(Environment::temporary());
  for (const int count : {1, 3, 200, 1, 40, 1000, 2, 2, 2, 500}) {
    map.add(count, random);
    const QuadReader reader = map.reader();
    const auto index = reader.geometries();
    EXPECT_EQ(index->size(), map.points().size());
    EXPECT_EQ(index->madeInMemory(), 0U) << "the index was not stored";
    for (const int from : {0, 100, 555, 900})
      EXPECT_EQ(index->meeting(square(from, from + 60)), map.expected(reader, from, from + 60));
    EXPECT_LE(index->trees().size(), 12U) << "small trees were not merged";
  }
}

TEST(GeometryIndex, GivesGeometriesByAscendingDistance) {
  std::mt19937 random(8);
  PointMap map(Environment::temporary());
  map.add(700, random);
  map.add(90, random);
  const QuadReader reader = map.reader();
  NearestGeometries nearest(reader.geometries(), square(500, 500));
  NearestGeometries::Found found;
  double before = 0;
  std::size_t count = 0;
  while (nearest.next(found)) {
    const Point& point = map.points().at(std::string(reader.viewOf(found.literal).text));
    EXPECT_GE(found.min_distance, before);
    EXPECT_NEAR(found.min_distance, std::hypot(point.x - 500, point.y - 500), 0.01);
    before = found.min_distance;
    ++count;
  }
  EXPECT_EQ(count, map.points().size());
}

TEST(GeometryIndex, HoldsGeometriesWithoutABoxApart) {
  std::mt19937 random(9);
  PointMap map(Environment::temporary());
  map.add(5, random);
  for (const char* text : {"POINT EMPTY", "POINT(1", "<http://www.opengis.net/def/crs/OGC/1.3/CRS84> POINT(1 1)"})
    map.write(Term::literal(text, kWkt));
  map.write(Term::literal("POINT(1 1)"));
  const QuadReader reader = map.reader();
  EXPECT_EQ(reader.geometries()->loose().size(), 3U);
  EXPECT_EQ(reader.geometries()->meeting(square(2000, 2001)), reader.geometries()->loose());
}

TEST(GeometryIndex, IsMadeInMemoryForAMapThatLacksItAndStoredWithTheNextGeometry) {
  std::mt19937 random(10);
  PointMap map(Environment::temporary());
  map.add(50, random);
  {
    WriteTransaction transaction = map.environment().write();  // as an earlier version leaves it
    std::vector<std::string> keys;
    transaction.forEachBlock("geometries", "", [&](std::string_view key, std::string_view) { keys.emplace_back(key); });
    for (const std::string& key : keys) transaction.eraseBlock("geometries", key);
    transaction.commit();
  }
  EXPECT_EQ(map.reader().geometries()->madeInMemory(), map.points().size());
  EXPECT_EQ(map.reader().geometries()->meeting(square(0, 500)), map.expected(map.reader(), 0, 500));
  map.add(1, random);
  EXPECT_EQ(map.reader().geometries()->madeInMemory(), 0U);
  EXPECT_EQ(map.reader().geometries()->size(), map.points().size());
}

TEST(GeometryIndex, IsRefusedWhenItsBytesAreMalformed) {
  for (const char* bytes : {"no tree", ""}) {
    std::mt19937 random(11);
    PointMap map(Environment::temporary());
    map.add(50, random);
    map.putBlock("run 1", bytes);
    EXPECT_THROW(map.reader().geometries(), Error) << "'" << bytes << "'";
  }
}

TEST(GeometryIndex, IsMadeInMemoryWhenItsHeadIsEmpty) {
  std::mt19937 random(12);
  PointMap map(Environment::temporary());
  map.add(50, random);
  map.putBlock("head", "");
  EXPECT_EQ(map.reader().geometries()->madeInMemory(), map.points().size());
}

TEST(GeometryIndex, IsComparedWithTheMapBoxByBox) {
  const ScratchFolder folder;
  const auto file = folder.path() / "map.clx";
  std::mt19937 random(13);
  {
    PointMap map(Environment::open(file, OpenMode::Create));
    for (const int count : {300, 20, 3}) map.add(count, random);
    map.write(Term::literal("POINT EMPTY", kWkt));
    map.write(Term::literal("POINT(7 7)"));
  }
  EXPECT_TRUE(checkMap(file).sound()) << checkMap(file).faults[0];
  struct Run {
    std::string key;
    GeometryEntries entries;
  };
  // Each change is written with right checksums, as a fault of the program would be.
  const auto changed = [&](const std::function<std::string(const Run&)>& bytes) {
    const auto copy = folder.path() / "copy.clx";
    std::filesystem::copy_file(file, copy, std::filesystem::copy_options::overwrite_existing);
    {
      const auto environment = Environment::open(copy, OpenMode::ReadWrite);
      WriteTransaction transaction = environment->write();
      Run run;
      transaction.forEachBlock("geometries", "run", [&](std::string_view key, std::string_view value) {
        std::vector<std::uint32_t> words(value.size() / 4);
        std::memcpy(words.data(), value.data(), value.size());
        const PackedTree tree({reinterpret_cast<const char*>(words.data()), value.size()});
        if (tree.size() > run.entries.boxed.size()) {
          run = {std::string(key), {}};
          tree.appendTo(run.entries);
        }
      });
      transaction.putBlock("geometries", run.key, bytes(run));
      transaction.commit();
    }
    const MapCheck check = checkMap(copy);
    return check.sound() ? std::string("sound") : check.faults[0];
  };
  const auto packed = [](GeometryEntries entries) { return packedTree(entries); };
  EXPECT_EQ(changed([&](const Run& run) { return packed(run.entries); }), "sound");
  EXPECT_THAT(changed([&](const Run& run) {
                GeometryEntries entries = run.entries;
                entries.boxed.pop_back();
                return packed(entries);
              }),
              HasSubstr("wrong count"));
  EXPECT_THAT(changed([&](const Run& run) {
                GeometryEntries entries = run.entries;
                entries.boxed[5].box.max_x += 1;
                return packed(entries);
              }),
              HasSubstr("not those of the"));
  EXPECT_THAT(changed([&](const Run& run) {
                GeometryEntries entries = run.entries;
                std::swap(entries.boxed[5].literal, entries.boxed[6].literal);
                return packed(entries);
              }),
              HasSubstr("not those of the"));
  EXPECT_THAT(changed([&](const Run& run) {
                std::string bytes = packed(run.entries);
                const FlatBox nowhere{0, 0, 0, 0};  // in place of the root
                std::memcpy(bytes.data() + bytes.size() - 4 * (run.entries.boxed.size() + run.entries.loose.size()) -
                                sizeof(FlatBox),
                            &nowhere, sizeof nowhere);
                return bytes;
              }),
              HasSubstr("do not fit those below"));
}

TEST(GeometryIndex, IsCopiedByCompaction) {
  const ScratchFolder folder;
  std::mt19937 random(12);
  PointMap map(Environment::temporary());
  map.add(300, random);
  map.environment().compactTo(folder.path() / "copy.clx");
  const auto copy = Environment::open(folder.path() / "copy.clx", OpenMode::ReadOnly);
  const QuadReader reader(copy->read());
  EXPECT_EQ(reader.geometries()->madeInMemory(), 0U);
  EXPECT_EQ(reader.geometries()->size(), map.points().size());
}

}  // namespace
}  // namespace cluxel::rdf
