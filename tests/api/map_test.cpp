// SPDX-License-Identifier: Apache-2.0
// The facade gives what the modules give, as values; errors keep their kind and place.
#include "cluxel/map.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "api/facade_campus.hpp"
#include "sparql/query_engine.hpp"
#include "tasks/explanation.hpp"
#include "test_paths.hpp"

namespace cluxel {
namespace {

using ::testing::HasSubstr;

const Map& mapOfCampus() {
  return FacadeCampus::shared().map;
}

ErrorKind kindOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.kind();
  }
  ADD_FAILURE() << "nothing was refused";
  return ErrorKind::InvalidArgument;
}

TEST(Map, IsBuiltAsTheModulesBuildIt) {
  FacadeCampus& shared = FacadeCampus::shared();
  mapping::MapInputFiles files;
  files.model = "campus";
  const std::string expected =
      mapping::builtText(shared.campus.files(), readMapInputs(files, DataHome(test::sourceFolder())), {.threads = 2});
  EXPECT_TRUE(mapping::canonicalText(shared.map.file()) == expected);
  EXPECT_GT(shared.sink.calls, 0U);
}

TEST(Map, IsNotReplacedUnlessForced) {
  FacadeCampus& shared = FacadeCampus::shared();
  const auto again = [&] { Map::build(shared.campus.files(), shared.map.file(), FacadeCampus::options()); };
  EXPECT_EQ(kindOf(again), ErrorKind::InvalidArgument);
}

TEST(Map, SumsUpAsTheReaderDoes) {
  const MapSummary summary = mapOfCampus().summary();
  const mapping::MapSummary expected = mapping::MapReader(mapOfCampus().file()).summary();
  EXPECT_TRUE(summary.is_finished);
  EXPECT_EQ(summary.inputs_hash, expected.inputs_hash);
  EXPECT_EQ(summary.clouds, expected.clouds);
  EXPECT_EQ(summary.points, expected.points);
  EXPECT_EQ(summary.quads, expected.quads);
  EXPECT_EQ(summary.objects_by_class, expected.objects_by_class);
}

TEST(Map, ExplainsAsTheTaskDoes) {
  const mapping::MapReader reader(mapOfCampus().file());
  const std::string name = mapOfCampus().objects().front().iri;
  const Explanation explanation = mapOfCampus().explain(name);
  EXPECT_EQ(explanation.text, tasks::explainThing(reader, name, false));
  EXPECT_EQ(explanation.json, tasks::explainThing(reader, name, true));
  EXPECT_TRUE(nlohmann::json::parse(explanation.json).is_object());
  EXPECT_EQ(kindOf([] { mapOfCampus().explain("zzzzzzzz"); }), ErrorKind::NotFound);
}

TEST(Map, IsUpdatedForAllItsReaders) {
  const rdf::ScratchFolder folder;
  Map map = FacadeCampus::shared().copyIn(folder.path());
  const Map other = Map::open(map.file());
  const Object object = other.objects().front();
  ASSERT_GT(other.points(object).size(), 0U);  // what was read before must not be served again
  const UpdateCounts counts =
      map.update("INSERT DATA { <" + object.iri + "> <http://example.org/name> \"the first\" }");
  EXPECT_EQ(counts.inserted, 1U);
  EXPECT_EQ(counts.deleted, 0U);
  for (const Map* reader : {static_cast<const Map*>(&map), &other}) {
    EXPECT_EQ(reader->query("SELECT ?o { ?o <http://example.org/name> \"the first\" }")[0].text("o"), object.iri);
    EXPECT_GT(reader->summary().quads, mapOfCampus().summary().quads);
  }
  EXPECT_EQ(kindOf([&] { map.update("LOAD <http://example.org/x.ttl>"); }), ErrorKind::FaultyInput);
}

TEST(Map, FollowsAFileThatIsReplaced) {
  const rdf::ScratchFolder folder;
  const Map map = FacadeCampus::shared().copyIn(folder.path());
  BuildOptions options = FacadeCampus::options();
  options.force = true;
  Map::build({FacadeCampus::shared().campus.files().front()}, map.file(), options);
  EXPECT_EQ(map.summary().clouds, 1U);
  EXPECT_EQ(map.clouds().size(), 1U);
}

TEST(Map, AnswersManyThreads) {
  std::vector<std::thread> threads;
  const std::size_t expected = mapOfCampus().objects().size();
  std::atomic<int> wrong = 0;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&] {
      for (int round = 0; round < 5; ++round) {
        wrong += mapOfCampus().objects().size() == expected ? 0 : 1;
        wrong += mapOfCampus().query("ASK { ?s ?p ?o }").boolean() ? 0 : 1;
        wrong += mapOfCampus().summary().objects == expected ? 0 : 1;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

TEST(Map, SaysWhatIsWrongWithAFile) {
  const rdf::ScratchFolder folder;
  EXPECT_EQ(kindOf([&] { Map::open(folder.path() / "absent.clx"); }), ErrorKind::StoreUnavailable);
  std::ofstream(folder.path() / "text.clx") << "this is no map, but long enough to be read as the head of one";
  EXPECT_EQ(kindOf([&] { Map::open(folder.path() / "text.clx"); }), ErrorKind::StoreUnavailable);
}

TEST(Map, NamesFileAndLineOfFaultyScans) {
  const rdf::ScratchFolder folder;
  const auto file = folder.path() / "scan.xyz";
  std::ofstream(file) << "1 2 3\n4 five 6\n";
  try {
    Map::build({file}, folder.path() / "map.clx", FacadeCampus::options());
    FAIL() << "nothing was refused";
  } catch (const InputError& error) {
    EXPECT_EQ(error.kind(), ErrorKind::FaultyInput);
    EXPECT_EQ(error.diagnostics().front().location.file, file.string());
    EXPECT_EQ(error.diagnostics().front().location.line, 2U);
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "map.clx"));
}

TEST(Map, RefusesOptionsThatContradictEachOther) {
  BuildOptions options = FacadeCampus::options();
  options.drop_statements = true;
  EXPECT_EQ(kindOf([&] { Map::build({}, "map.clx", options); }), ErrorKind::InvalidArgument);
  options = FacadeCampus::options();
  options.batch_points = 0;
  EXPECT_EQ(kindOf([&] { Map::build({}, "map.clx", options); }), ErrorKind::InvalidArgument);
}

TEST(Map, RefusesPathsThatAreEmptyOrThatNoFileCanHave) {
  ProgressSink silence;
  const rdf::ScratchFolder folder;
  const auto files = FacadeCampus::shared().campus.files();
  const BuildOptions options = FacadeCampus::options();
  Map map = FacadeCampus::shared().copyIn(folder.path());
  EXPECT_EQ(kindOf([] { Map::open(""); }), ErrorKind::InvalidArgument);
  EXPECT_EQ(kindOf([&] { Map::open("", silence); }), ErrorKind::InvalidArgument);
  EXPECT_EQ(kindOf([&] { Map::build(files, "", options); }), ErrorKind::InvalidArgument);
  EXPECT_EQ(kindOf([&] {
              Map::merge({map.file(), ""}, folder.path() / "new.clx", {}, silence);
            }),
            ErrorKind::InvalidArgument);
  EXPECT_EQ(kindOf([&] { Map::merge({map.file()}, "", {}, silence); }), ErrorKind::InvalidArgument);
  EXPECT_EQ(kindOf([&] { Map::build({""}, folder.path() / "new.clx", options); }), ErrorKind::FaultyInput);
  EXPECT_EQ(kindOf([&] { map.extend({""}, {}, silence); }), ErrorKind::FaultyInput);
  const std::filesystem::path far_too_long = folder.path() / std::string(1000, 'x');
  for (const auto& call : std::vector<std::function<void()>>{
           [&] { Map::open(far_too_long); }, [&] { Map::build(files, far_too_long, options); },
           [&] { Map::build({far_too_long}, folder.path() / "new.clx", options); },
           [&] { map.extend({far_too_long}, {}, silence); },
           [&] { map.extend(files, {.poses = far_too_long}, silence); },
           [&] { Map::merge({map.file()}, far_too_long, {}, silence); },
           [&] { Map::merge({far_too_long}, folder.path() / "new.clx", {}, silence); }})
    EXPECT_THROW(call(), Error);
  BuildOptions homeless = options;
  homeless.home = far_too_long;
  EXPECT_THROW(Map::build(files, folder.path() / "new.clx", homeless), Error);
}

TEST(Map, LimitsTimeAndMemoryOfAnUpdate) {
  const rdf::ScratchFolder folder;
  Map map = FacadeCampus::shared().copyIn(folder.path());
  const std::string all = "INSERT { ?a <http://example.org/p> ?f } WHERE { ?a ?b ?c . ?d ?e ?f }";
  EXPECT_EQ(kindOf([&] { map.update(all, {.deadline = std::chrono::milliseconds(5)}); }), ErrorKind::BudgetExceeded);
  EXPECT_EQ(kindOf([&] { map.update(all, {.max_memory_bytes = 1 << 20}); }), ErrorKind::BudgetExceeded);
  EXPECT_EQ(kindOf([&] { map.update("INSERT DATA {}", {.deadline = std::chrono::milliseconds(-1)}); }),
            ErrorKind::InvalidArgument);
  UpdateOptions options;
  options.poll = [&] { map.update("INSERT DATA {}"); };
  EXPECT_EQ(kindOf([&] { map.update(all, options); }), ErrorKind::InvalidArgument) << "it would wait for itself";
  try {
    map.update("INSERT DATA { <a", {.source_name = "mine.ru"});
    FAIL() << "nothing was refused";
  } catch (const InputError& error) {
    EXPECT_EQ(error.diagnostics().front().location.file, "mine.ru");
  }
  EXPECT_EQ(map.summary().quads, mapOfCampus().summary().quads) << "nothing was changed";
}

class NoteKeeper : public ProgressSink {
 public:
  void note(std::string_view message) override { notes += std::string(message) + '\n'; }
  std::string notes;
};

TEST(Map, WhoseBuildIsUnfinishedSaysSoToTheSink) {
  const FacadeCampus& shared = FacadeCampus::shared();
  const rdf::ScratchFolder folder;
  const std::filesystem::path cut = folder.path() / "cut.pcd", file = folder.path() / "map.clx";
  std::filesystem::copy_file(shared.campus.files()[1], cut);
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) - 100);
  BuildOptions options = FacadeCampus::options();
  options.batch_points = 1;
  EXPECT_EQ(kindOf([&] { Map::build({shared.campus.files()[0], cut}, file, options); }), ErrorKind::FaultyInput);
  NoteKeeper unfinished, finished;
  EXPECT_FALSE(Map::open(file, unfinished).summary().is_finished);
  EXPECT_THAT(unfinished.notes, HasSubstr("the build of this map is unfinished"));
  Map::open(shared.map.file(), finished);
  EXPECT_EQ(finished.notes, "");
}

TEST(Library, TellsItsVersion) {
  EXPECT_THAT(std::string(version()), testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
}

}  // namespace
}  // namespace cluxel
