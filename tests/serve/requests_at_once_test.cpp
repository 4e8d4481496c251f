// SPDX-License-Identifier: Apache-2.0
// Requests of one map at the same time: a long one holds up no other, and all answer as they would alone.
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <set>
#include <thread>
#include <vector>

#include "mapping/small_campus.hpp"
#include "rdf/file/check/commit_name.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"
#include "serve/map_service.hpp"

namespace cluxel::serve {
namespace {

const std::string kToken = "a token of 16 and more characters";
const std::string kAsk = "/sparql?format=csv&query=ASK%20%7B%3Chttps%3A%2F%2Fe.org%2Fa%3E%20%3Fp%20%3Fo%7D";

/// A page that takes as long as the test wants: it reads layers, tells so, and waits.
struct SlowPage {
  std::promise<void> begun, end;
  std::shared_future<void> ended{end.get_future()};
  std::atomic<int> made = 0;
  bool is_same = false;  ///< whether the layers that it read first stayed as they were

  std::string operator()(const mapping::MapReader& map) {
    if (++made > 1) return "made again";
    const mapping::TileStages& stages = map.stages();
    const std::size_t tiles = stages.summaries().size(), with_points = stages.points().size();
    const perception::Scene& scene = map.scene();
    const std::size_t primitives = scene.primitives.size();
    begun.set_value();
    ended.wait();
    is_same = &map.stages() == &stages && stages.summaries().size() == tiles && stages.points().size() == with_points &&
              &map.scene() == &scene && scene.primitives.size() == primitives;
    return "made";
  }
};

class RequestsAtOnce : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new rdf::ScratchFolder;
    const mapping::SmallCampus campus({.seed = 3, .stops = 2, .size_m = 50, .points_per_stop = 3000});
    buildMap(mapping::scansOf(campus.files()), mapping::shippedInputs(), folder->path() / "map.clx", {.threads = 2},
             mapping::silence());
  }
  static void TearDownTestSuite() { delete folder; }
  void SetUp() override { std::filesystem::copy_file(folder->path() / "map.clx", file, kOver); }

  std::unique_ptr<MapService> service(std::size_t running, SlowPage* page = nullptr) const {
    ServiceOptions options;
    options.load.running = running;
    options.token = kToken;
    if (page != nullptr)
      options.page = [page](const mapping::MapReader& map, const std::string&) { return (*page)(map); };
    return std::make_unique<MapService>(std::vector<MapArgument>{{"map", file}}, DataHome(test::sourceFolder()),
                                        options);
  }
  static HttpResponse get(MapService& service, const std::string& target) {
    HttpRequest request;
    request.target = target;
    return service.handle(request);
  }
  static HttpResponse insert(MapService& service, const std::string& object) {
    return service.handle(
        {.method = "POST",
         .target = "/sparql",
         .headers = {{"authorization", "Bearer " + kToken}, {"content-type", "application/sparql-update"}},
         .body = "INSERT DATA { <https://e.org/a> rdfs:label \"" + object + "\" }"});
  }
  /// One of each kind of request that reads the layers of the map, and some that do not.
  static std::vector<std::string> targets() {
    std::vector<std::string> all{"/objects/%230/explanation",
                                 "/objects/%231/explanation?whyNot=Tree",
                                 "/objects/%230/points",
                                 "/tasks/count_by_class",
                                 "/tasks/trees",
                                 "/tasks/route?from=0,0&to=3,2",
                                 "/objects?class=Tree",
                                 kAsk};
    for (const char* place : {"-1/-1", "-1/0", "0/-1", "0/0"}) all.push_back(std::string("/tiles/") + place);
    return all;
  }

  static constexpr auto kOver = std::filesystem::copy_options::overwrite_existing;
  static inline rdf::ScratchFolder* folder = nullptr;
  const std::filesystem::path file = folder->path() / "served.clx";
};

/// Whether `work` ends although another request does not. It ends that one if not, so that the test goes on.
bool endsBeside(SlowPage& page, const std::function<void()>& work) {
  std::future<void> done = std::async(std::launch::async, work);
  const bool has_ended = done.wait_for(std::chrono::seconds(120)) == std::future_status::ready;
  if (!has_ended) page.end.set_value();
  done.get();
  return has_ended;
}

TEST_F(RequestsAtOnce, ALongOneHoldsUpNoOtherOfItsMap) {
  SlowPage page;
  const auto served = service(2, &page);
  auto slow = std::async(std::launch::async, [&] { return get(*served, "/page"); });
  page.begun.get_future().wait();
  std::vector<std::string> beside = targets();
  beside.emplace_back("/tasks/search?for=Tree&from=0,0");
  for (const std::string& target : beside) {
    HttpResponse response;
    ASSERT_TRUE(endsBeside(page, [&] { response = get(*served, target); })) << target;
    EXPECT_EQ(response.status, 200) << target << ": " << response.body;
  }
  HttpResponse updated;
  ASSERT_TRUE(endsBeside(page, [&] { updated = insert(*served, "one"); }));
  EXPECT_EQ(updated.status, 200) << updated.body;
  ASSERT_TRUE(endsBeside(page, [&] { served->tidy(); }));
  EXPECT_EQ(get(*served, "/objects/%230/points").status, 200);
  page.end.set_value();
  EXPECT_EQ(slow.get().body, "made");
  EXPECT_TRUE(page.is_same) << "what a request holds changes under it";
  EXPECT_EQ(get(*served, "/page").body, "made again") << "the page of the commit before is not that of this one";
}

TEST_F(RequestsAtOnce, AllAnswerAsTheyWouldAlone) {
  std::vector<std::string> alone;
  const auto one = service(1);
  for (const std::string& target : targets()) alone.push_back(get(*one, target).body);
  constexpr std::size_t kThreads = 5;
  for (int round = 0; round < 3; ++round) {
    const auto many = service(kThreads);
    std::vector<std::thread> threads;
    std::atomic<int> different = 0;
    for (std::size_t thread = 0; thread < kThreads; ++thread)
      threads.emplace_back([&, thread] {
        for (std::size_t i = 0; i < alone.size(); ++i) {
          const std::size_t which = (i * 5 + thread * 3) % alone.size();
          if (get(*many, targets()[which]).body != alone[which]) ++different;
        }
      });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(different, 0);
  }
}

/// The page of this test tells the classes of the objects, which readers of a commit share.
TEST_F(RequestsAtOnce, NoneAnswersFromBeforeAnUpdateThatWasReported) {
  const auto classes = [](const mapping::MapReader& map, const std::string&) {
    std::string text;
    for (const rules::SemanticObject& object : map.objects()) text += object.class_iri + "\n";
    return text;
  };
  ServiceOptions options;
  options.load.running = 4;
  options.token = kToken;
  options.page = classes;
  MapService served({{"map", file}}, DataHome(test::sourceFolder()), options);
  std::atomic<bool> is_over = false;
  std::thread reader([&] {
    while (!is_over) get(served, "/objects/%230/explanation"), get(served, "/page");
  });
  std::vector<std::string> things;
  {
    const mapping::MapReader map(file);
    for (const rules::SemanticObject& object : map.objects())
      if (!map.isClassWide(object.id) && things.size() < 3) things.push_back(rdf::iriOfObject(object.id));
  }
  EXPECT_EQ(things.size(), 3U);
  for (const std::string& thing : things) {
    const std::string before = get(served, "/page").body;
    const HttpResponse updated = served.handle(
        {.method = "POST",
         .target = "/sparql",
         .headers = {{"authorization", "Bearer " + kToken}, {"content-type", "application/sparql-update"}},
         .body = "INSERT DATA { <" + thing + "> a <" + rdf::vocabulary::clx("TrafficLight") + "> }"});
    EXPECT_EQ(updated.status, 200) << updated.body;
    const std::string now = get(served, "/page").body;
    EXPECT_NE(now, before) << "the objects of the commit before";
    EXPECT_EQ(now, classes(mapping::MapReader(file), ""));
    served.tidy();
  }
  is_over = true;
  reader.join();
}

/// A commit says of all objects that they are gone, or of none.
TEST_F(RequestsAtOnce, AListOfObjectsIsOfOneCommit) {
  const auto served = service(4);
  std::vector<Quad> gone;
  {
    const mapping::MapReader map(file);
    for (const ContentHash& object : map.objectIds())
      gone.push_back({Term::iri(rdf::iriOfObject(object)), Term::iri(rdf::vocabulary::clx("seenThrough")),
                      Term::literal("2026-01-01T00:00:00Z", rdf::vocabulary::xsd("dateTime")),
                      Term::iri(std::string(rdf::vocabulary::kGraphObserved))});
  }
  ASSERT_GT(gone.size(), 5U);
  std::atomic<bool> is_over = false;
  std::atomic<int> mixed = 0, lists = 0;
  std::thread reader([&] {
    while (!is_over) {
      const std::string list = get(*served, "/objects").body;
      std::size_t count = 0;
      for (std::size_t at = list.find("seenThrough"); at != std::string::npos; at = list.find("seenThrough", at + 1))
        ++count;
      if (count != 0 && count != gone.size()) ++mixed;
      ++lists;
    }
  });
  const auto environment = rdf::Environment::open(file, rdf::OpenMode::ReadWrite);
  for (int round = 0; round < 120 || lists < 20; ++round) {
    rdf::WriteTransaction transaction = environment->write();
    rdf::QuadWriter writer(transaction);
    for (const Quad& quad : gone) {
      const rdf::QuadIds ids{writer.intern(quad.subject), writer.intern(quad.predicate), writer.intern(quad.object),
                             writer.intern(quad.graph)};
      round % 2 == 0 ? writer.add(ids) : writer.remove(ids);
    }
    writer.flush();
    transaction.commit();
  }
  is_over = true;
  reader.join();
  EXPECT_EQ(mixed, 0);
}

std::string stateIn(const HttpResponse& response) {
  for (const auto& [name, value] : response.headers)
    if (name == "Cluxel-State") return value;
  return {};
}

/// A page knows by it whether an answer is of the map that it shows.
TEST_F(RequestsAtOnce, TheHeaderOfAnAnswerNamesItsCommit) {
  const auto served = service(2);
  const auto nameNow = [&] { return rdf::commitName(rdf::Environment::open(file, rdf::OpenMode::ReadOnly)->read()); };
  std::set<std::string> names;
  for (const char* what : {"", "one", "two"}) {
    if (*what != 0) {
      const HttpResponse updated = insert(*served, what);
      EXPECT_EQ(updated.status, 200) << updated.body;
      EXPECT_EQ(stateIn(updated), "changed");
    }
    std::vector<std::string> all = targets();
    all.insert(all.end(), {"/maps/map", "/page", "/objects/ffff0000", "/tiles/0/0?state=old", "/sparql?query=SELECT"});
    for (const std::string& target : all) EXPECT_EQ(stateIn(get(*served, target)), nameNow()) << target;
    EXPECT_TRUE(names.insert(nameNow()).second) << "each commit has a name of its own";
  }
  EXPECT_EQ(stateIn(get(*served, "/maps")), "") << "no map is asked";
  EXPECT_EQ(stateIn(get(*service(1), "/objects")), nameNow()) << "another service knows the same state";
}

TEST_F(RequestsAtOnce, AnAnswerDuringWhichACommitCameHasTheNameOfNone) {
  SlowPage page;
  const auto served = service(2, &page);
  auto slow = std::async(std::launch::async, [&] { return get(*served, "/page"); });
  page.begun.get_future().wait();
  EXPECT_EQ(insert(*served, "one").status, 200);
  page.end.set_value();
  EXPECT_EQ(stateIn(slow.get()), "changed");
}

TEST_F(RequestsAtOnce, TheStateOfAMapThatIsAwayIsUnknown) {
  const auto served = service(2);
  std::filesystem::rename(file, folder->path() / "away.clx");
  served->tidy();
  const HttpResponse away = get(*served, "/objects");
  EXPECT_EQ(away.status, 503);
  EXPECT_EQ(stateIn(away), "unknown");
  std::filesystem::create_symlink(file.filename(), file);
  EXPECT_EQ(stateIn(get(*served, "/objects")), "unknown") << "a link to itself is a fault of the file system";
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace cluxel::serve
