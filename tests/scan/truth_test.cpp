// SPDX-License-Identifier: Apache-2.0
// Label maps, truth from labels, and truth files.
#include "scan/truth/truth.hpp"

#include <zlib.h>

#include <random>

#include "scan/scan_fixture.hpp"
#include "scan/scan_set.hpp"
#include "scan/truth/truth_parsers.hpp"

namespace cluxel::scan {
namespace {

using test::refusalOf;
using test::ScratchFolder;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string gzipped(const std::string& text) {
  std::string packed(compressBound(text.size()) + 64, '\0');
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

const std::string kMap =
    "dataset: test\nlabels:\n"
    "  1: {name: grass, primitive: horizontal_plane, object: Ground}\n"
    "  2: {name: sign, primitive: small_structure, object: StreetSign, part: SignPlate}\n"
    "  3: {name: post, primitive: column, object: SmallObject, near: {label: 2, within: 0.6 m, object: "
    "StreetSign}}\n"
    "  4: {name: bench, primitive: small_structure, object: Bench}\n"
    "  5: {name: wire}\n";

LabelMap mapOf(const std::string& text) {
  const ScratchFolder folder;
  return LabelMap::load(folder.write("map.yaml", text));
}

Scan labelled(const std::vector<std::array<float, 2>>& places, const std::vector<std::uint32_t>& labels) {
  Scan scan;
  for (const auto& [x, y] : places) {
    scan.points.x.push_back(x);
    scan.points.y.push_back(y);
    scan.points.z.push_back(0);
  }
  scan.points.label = labels;
  return scan;
}

TEST(LabelMap, GivesTheMeaningOfEachId) {
  const LabelMap map = mapOf(kMap);
  ASSERT_NE(map.find(2), nullptr);
  EXPECT_EQ(map.find(2)->primitive, PrimitiveLabel::SmallStructure);
  EXPECT_EQ(map.find(2)->object_class, "StreetSign");
  EXPECT_EQ(map.find(2)->part, "SignPlate");
  EXPECT_EQ(map.find(3)->near->within_m, 0.6);
  EXPECT_FALSE(map.find(5)->primitive.has_value());
  EXPECT_EQ(map.find(99), nullptr);
}

TEST(LabelMap, TakesWhateverLocalNameAnOntologyMayHave) {
  for (const std::string name : {"StreetSign", "Straßen-Schild", "a.b", "3D_Sign", "Baum%20A"}) {
    const LabelMap map =
        mapOf("counts_as: {'" + name + "': '" + name + "'}\nlabels:\n  1: {name: a, object: '" + name + "'}\n");
    EXPECT_EQ(map.find(1)->object_class, name);
  }
  for (const std::string name : {"a tree", "clx:Tree", "<Tree>", "town/Tree", "town#Tree", ""})
    EXPECT_THAT(refusalOf([&] { parseLabelMap("labels:\n  1: {name: a, object: '" + name + "'}\n", "l"); }),
                HasSubstr("object must be a local name"))
        << name;
}

TEST(LabelMap, ReportsAllFaultsAtOnceWithPlaceAndSuggestion) {
  const std::string text = refusalOf([] {
    parseLabelMap(
        "datset: x\nlabels:\n  1: {name: a, primitive: colum}\n  1: {name: b}\n  -3: {name: c}\n  4: "
        "{object: Tree}\n"
        "  5: {name: d, object: a tree}\n  6: {name: e, near: {label: 77, within: 0.6, object: Tree}}\n  7: "
        "{name: f, part: Top}\n",
        "l.yaml");
  });
  EXPECT_THAT(text, AllOf(HasSubstr("l.yaml:1:1: error: unknown key 'datset'"), HasSubstr("did you mean 'dataset'?")));
  EXPECT_THAT(text,
              AllOf(HasSubstr("l.yaml:3:27: error: unknown primitive 'colum'"), HasSubstr("did you mean 'column'?")));
  EXPECT_THAT(text, HasSubstr("l.yaml:4:3: error: the key '1' stands here twice"));
  EXPECT_THAT(text, AllOf(HasSubstr("a label id is a whole number"), HasSubstr("a label needs a 'name'")));
  EXPECT_THAT(text, AllOf(HasSubstr("object must be a local name"), HasSubstr("write it as '0.6 m'")));
  EXPECT_THAT(text, AllOf(HasSubstr("the label 77 is not in this map"), HasSubstr("a 'part' needs an 'object'")));
}

TEST(LabelMap, TakesTheSameIdInTwoSpellingsForADuplicate) {
  EXPECT_THAT(refusalOf([] { parseLabelMap("labels:\n  7: {name: a}\n  07: {name: b}\n", "l"); }),
              HasSubstr("the id 7 stands twice"));
}

TEST(LabelMap, SaysWhatAnswersCountAsAndWhatItsLabelsCover) {
  const std::string labels = "labels:\n  1: {name: wall, object: Static}\n";
  const LabelMap plain = mapOf(labels);
  EXPECT_TRUE(plain.coversAll());
  EXPECT_EQ(plain.instanceField(), "");
  EXPECT_TRUE(plain.countsAs().empty());
  const LabelMap full =
      mapOf("coverage: some\ninstance_field: number\ncounts_as: {Building: Static, Pole: Tree}\n" + labels);
  EXPECT_FALSE(full.coversAll());
  EXPECT_EQ(full.instanceField(), "number");
  EXPECT_EQ(full.countsAs().at("Building"), "Static");
  EXPECT_EQ(full.countsAs().at("Pole"), "Tree");
}

TEST(LabelMap, RefusesWhatAnswersCannotCountAs) {
  const std::string text = refusalOf([] {
    parseLabelMap(
        "coverage: most\ncounts_as: {Building: Statik, a wall: Static}\nlabels:\n  1: {name: wall, object: Static}\n",
        "l.yaml");
  });
  EXPECT_THAT(text, HasSubstr("l.yaml:1:11: error: coverage must be 'all' or 'some'"));
  EXPECT_THAT(text, AllOf(HasSubstr("l.yaml:2:23: error: the truth has no class 'Statik'"),
                          HasSubstr("did you mean 'Static'?"), HasSubstr("l.yaml:2:31: error: a key of counts_as")));
  EXPECT_THAT(refusalOf([] { parseLabelMap("counts_as: Tree\nlabels:\n  1: {name: a}\n", "l"); }),
              HasSubstr("counts_as must be a mapping"));
}

TEST(LabelMap, ThoseThatAreShippedCanBeRead) {
  for (const auto& entry : std::filesystem::directory_iterator(test::sourceFolder() / "labels"))
    EXPECT_FALSE(LabelMap::load(entry.path()).entries().empty()) << entry.path();
}

/// Three points of a PLY file with the usual label and a number of objects.
std::string numberedPly(const std::string& last_number) {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "property uchar label\nproperty int number\nend_header\n"
         "0 0 0 9 7\n1 0 0 8 -1\nnan 0 0 8 5\n2 0 0 7 " +
         last_number + "\n";
}

Scan scanOf(const std::filesystem::path& file, const ScanSetParams& params = {}) {
  ProgressSink silent;
  return ScanSet::open({file}, params, silent).load(0);
}

TEST(InstancesFromFile, AreTheFieldOfTheScansPoints) {
  const ScratchFolder folder;
  const Scan scan = scanOf(folder.write("scan.ply", numberedPly("0")));
  EXPECT_THAT(instancesFromFile(scan, "number"), ElementsAre(7, -1, 0)) << "the record without a return is no point";
  EXPECT_THAT(instancesFromFile(scan, "label"), ElementsAre(9, 8, 7));
}

TEST(InstancesFromFile, AreThoseOfAScanInAnyUnitAndPlace) {
  const ScratchFolder folder;
  const auto file = folder.write("scan.ply", numberedPly("0"));
  for (const UpAxis up : {UpAxis::Z, UpAxis::Y})
    for (const LengthUnit unit : {LengthUnit::Metre, LengthUnit::Centimetre, LengthUnit::Millimetre, LengthUnit::Foot,
                                  LengthUnit::UsSurveyFoot})
      EXPECT_THAT(instancesFromFile(scanOf(file, {.poses = {}, .frame = {unit, up}}), "number"), ElementsAre(7, -1, 0))
          << nameOf(unit);
  // Points far from the origin are kept beside a local one: in the map it is part of the pose, or of the points.
  std::string far = numberedPly("0");
  for (const char* point : {"0 0 0 9 7", "1 0 0 8 -1", "2 0 0 7 0"}) far.insert(far.find(point), "50000");
  const auto place = folder.write("place.ply", far);
  EXPECT_THAT(instancesFromFile(scanOf(place), "number"), ElementsAre(7, -1, 0));
  Scan reposed = scanOf(place);
  reposed.has_pose = true;  // as a map tells of a scan that got a pose later
  EXPECT_THAT(instancesFromFile(reposed, "number"), ElementsAre(7, -1, 0));
  ScanSetParams posed;
  posed.poses = folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  posed.frame.unit = LengthUnit::Millimetre;
  EXPECT_THAT(instancesFromFile(scanOf(place, posed), "number"), ElementsAre(7, -1, 0));
}

TEST(InstancesFromFile, RefusesWhatDoesNotFitTheMap) {
  const ScratchFolder folder;
  Scan scan = scanOf(folder.write("scan.ply", numberedPly("3000000000")));
  EXPECT_THAT(refusalOf([&] { instancesFromFile(scan, "number"); }), HasSubstr("holds 3000000000"));
  EXPECT_THAT(refusalOf([&] { instancesFromFile(scan, "numbers"); }), HasSubstr("has no field 'numbers'"));
  scan.points.x.push_back(0);
  EXPECT_THAT(refusalOf([&] { instancesFromFile(scan, "label"); }), HasSubstr("3 points where the map's scan has 4"));
  scan.source = folder.path() / "b.ply";
  EXPECT_THAT(refusalOf([&] { instancesFromFile(scan, "n"); }), HasSubstr("is not there"));
  EXPECT_THAT(refusalOf([&] { instancesFromFile(scanOf(folder.write("a.xyz", "0 0 0\n")), "n"); }),
              HasSubstr("is no PLY file"));
}

TEST(InstancesFromFile, RefusesAFileThatHoldsAnotherScanNow) {
  const ScratchFolder folder;
  const Scan scan = scanOf(folder.write("scan.ply", numberedPly("0")));
  std::string other = numberedPly("0");
  other.replace(other.find("1 0 0 8"), 7, "3 0 0 8");
  std::string reordered = numberedPly("0");
  const std::size_t body = reordered.find("0 0 0 9 7\n");
  reordered.erase(body, 10).append("0 0 0 9 7\n");
  for (const std::string& text : {other, reordered}) {
    folder.write("scan.ply", text);
    EXPECT_THAT(refusalOf([&] { instancesFromFile(scan, "number"); }), HasSubstr("holds another scan now")) << text;
  }
}

TEST(TruthFromLabels, LooksUpEachPointAndAddsClassesItDoesNotKnow) {
  const PointTruth truth =
      truthFromLabels(labelled({{0, 0}, {9, 9}, {5, 5}, {6, 6}, {7, 7}}, {1, 4, 5, 42, 3}), mapOf(kMap));
  EXPECT_THAT(truth.primitive, ElementsAre(0, 3, -1, -1, 2));
  EXPECT_THAT(truth.object_class, ElementsAre(0, 9, -1, -1, 8));
  EXPECT_EQ(truth.class_names.at(9), "Bench");
  EXPECT_THAT(truth.instance, ElementsAre(-1, -1, -1, -1, -1));
}

TEST(TruthFromLabels, AgreesWithBruteForceOnPostsNearSigns) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> metres(-4, 4);
  Scan scan;
  for (int i = 0; i < 600; ++i) {
    scan.points.x.push_back(metres(random));
    scan.points.y.push_back(metres(random));
    scan.points.z.push_back(metres(random));
    scan.points.label.push_back(i % 20 == 0 ? 2 : 3);
  }
  scan.T_map_sensor.translation() = Eigen::Vector3d(1e6, -1e6, 0);
  const PointTruth truth = truthFromLabels(scan, mapOf(kMap));
  std::size_t near_posts = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    bool near = scan.points.label[i] == 2;
    for (std::size_t k = 0; k < scan.points.size() && !near; ++k)
      near = scan.points.label[k] == 2 && std::hypot(double(scan.points.x[i]) - double(scan.points.x[k]),
                                                     double(scan.points.y[i]) - double(scan.points.y[k])) < 0.6;
    near_posts += near ? 1 : 0;
    EXPECT_EQ(truth.object_class[i], near ? 5 : 8) << i;
  }
  EXPECT_GT(near_posts, 100U);
  EXPECT_LT(near_posts, 550U);
}

TEST(TruthFromLabels, RefusesAScanWithoutLabels) {
  EXPECT_THAT(refusalOf([] {
                truthFromLabels(labelled({{0, 0}}, {}), mapOf(kMap));
              }),
              HasSubstr("the scan has no labels"));
}

TEST(TruthFiles, ReadPlainAndGzipAlike) {
  const std::string text = "1 2 31\n-1 -1 -1\n";
  for (const std::string& bytes : {text, gzipped(text), gzipped("1 2 31\n") + gzipped("-1 -1 -1\n")}) {
    const PointTruth truth = parseTruth(bytes, "a.truth", 2);
    EXPECT_THAT(truth.primitive, ElementsAre(1, -1));
    EXPECT_THAT(truth.object_class, ElementsAre(2, -1));
    EXPECT_THAT(truth.instance, ElementsAre(31, -1));
  }
}

TEST(TruthFiles, AreRefusedWithFileAndLine) {
  EXPECT_THAT(refusalOf([] { parseTruth("1 2 3\n5 2 3\n", "a", 2); }),
              HasSubstr("a:2:1: error: primitive must be a whole number from -1 to 4"));
  EXPECT_THAT(refusalOf([] { parseTruth("1 9 3\n", "a", 1); }),
              HasSubstr("object must be a whole number from -1 to 8"));
  EXPECT_THAT(refusalOf([] { parseTruth("1 2 -2\n", "a", 1); }), HasSubstr("instance must be"));
  EXPECT_THAT(refusalOf([] { parseTruth("1 2 3\n", "a", 2); }), HasSubstr("ends after 1 lines for 2 points"));
  EXPECT_THAT(refusalOf([] { parseTruth("1 2 3\n1 2 3\n", "a", 1); }),
              HasSubstr("a:2:1: error: more lines than the scan's 1 points"));
  EXPECT_THAT(refusalOf([] { parseTruth("1 2\n", "a", 1); }), HasSubstr("the line ends where instance was expected"));
}

TEST(TruthFiles, ThatAreDamagedOrEndlessAreRefused) {
  const std::string packed = gzipped(std::string(100, '1'));
  EXPECT_THAT(refusalOf([&] { parseTruth(packed.substr(0, packed.size() - 9), "a", 1); }),
              HasSubstr("the gzip data are cut off"));
  std::string damaged = packed;
  damaged[packed.size() - 8] ^= 1;
  EXPECT_THAT(refusalOf([&] { parseTruth(damaged, "a", 1); }), HasSubstr("the gzip data are damaged"));
  EXPECT_THAT(refusalOf([] { parseTruth(gzipped(std::string(10'000'000, ' ')), "a", 1); }),
              HasSubstr("unpacks to more than"));
}

TEST(TruthFiles, AreFoundByTheStemOfTheScan) {
  const ScratchFolder folder;
  const auto packed = folder.write("chunk_ac.truth.gz", "");
  EXPECT_EQ(truthFileOf(folder.path(), "/elsewhere/chunk_ac.xyz_label_conf"), packed);
  EXPECT_EQ(truthFileOf(folder.path(), "chunk_ad.pcd"), std::nullopt);
}

TEST(TruthFiles, ThatAreThereTwiceAreRefused) {
  const ScratchFolder folder;
  folder.write("chunk_ac.truth.gz", "");
  const auto plain = folder.write("chunk_ac.truth", "");
  EXPECT_THAT(refusalOf([&] { (void)truthFileOf(folder.path(), "chunk_ac.pcd"); }),
              ::testing::AllOf(HasSubstr("chunk_ac.truth.gz: error: the same truth is there unpacked"),
                               HasSubstr("keep one of the two files")));
  std::filesystem::remove(folder.path() / "chunk_ac.truth.gz");
  EXPECT_EQ(truthFileOf(folder.path(), "chunk_ac.pcd"), plain);
}

TEST(TruthFiles, OfScansOfOneNameLieBelowTheNamesOfTheirFolders) {
  const ScratchFolder folder;
  const auto plain = folder.write("000000.truth", "");
  std::filesystem::create_directory(folder.path() / "01");
  const auto own = folder.write("01/000000.truth", "");
  EXPECT_EQ(truthFileOf(folder.path(), "/elsewhere/01/000000.bin"), own);
  EXPECT_EQ(truthFileOf(folder.path(), "/elsewhere/02/000000.bin"), plain);
}

TEST(TruthClassNames, OfALabelMapAreTheNineAndThenItsOwn) {
  const ScratchFolder folder;
  const LabelMap map = LabelMap::load(folder.write("m.yaml",
                                                   "dataset: d\nlabels:\n  7: {name: a, object: Tree}\n  8: {name: b, "
                                                   "object: Bench}\n  9: {name: c, object: Bench}\n"));
  std::vector<std::string> names = truthClassNames();
  names.push_back("Bench");
  EXPECT_EQ(truthClassNames(map), names);
}

TEST(AmbiguousInstances, AreThoseMarkedInTheTable) {
  EXPECT_THAT(parseAmbiguousInstances("id,object,ambiguous,flags\n9,tree,1,x;\n2,tree,0,\n4,sign,1,\r\n", "i.csv"),
              ElementsAre(4, 9));
  EXPECT_THAT(parseAmbiguousInstances("\xEF\xBB\xBFid,ambiguous\n4,1\n", "i.csv"), ElementsAre(4));
  EXPECT_THAT(refusalOf([] { parseAmbiguousInstances("", "i.csv"); }), HasSubstr("is empty"));
  EXPECT_THAT(refusalOf([] { parseAmbiguousInstances("id,object\n", "i.csv"); }),
              HasSubstr("i.csv:1: error: has no column 'ambiguous'"));
  EXPECT_THAT(refusalOf([] { parseAmbiguousInstances("id,ambiguous\n1,1\nx,1\n", "i.csv"); }),
              HasSubstr("i.csv:3: error: the id is not a whole number"));
  EXPECT_THAT(refusalOf([] { parseAmbiguousInstances("id,ambiguous\n1,yes\n", "i.csv"); }),
              HasSubstr("must be 0 or 1"));
  EXPECT_THAT(refusalOf([] { parseAmbiguousInstances("id,ambiguous\n1\n", "i.csv"); }), HasSubstr("too few columns"));
  const ScratchFolder folder;
  EXPECT_TRUE(ambiguousInstances(folder.path()).empty());
}

}  // namespace
}  // namespace cluxel::scan
