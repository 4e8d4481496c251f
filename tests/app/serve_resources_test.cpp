// SPDX-License-Identifier: Apache-2.0
// `cluxel serve` by its sockets: objects, explanations, points, questions, several maps, updates.
#include <nlohmann/json.hpp>

#include "app/serve_fixture.hpp"
#include "base/file_bytes.hpp"

namespace cluxel::app {
namespace {

using ServeJson = nlohmann::json;

ServeJson jsonOf(const Reply& reply) {
  EXPECT_EQ(reply.status, 200) << reply.body;
  EXPECT_EQ(reply.header("Content-Type"), "application/json");
  return ServeJson::parse(reply.body);
}

TEST_F(ServeCommand, ListsItsMapsAndTheirObjects) {
  const ServeJson map = jsonOf(shared().get("/maps")).at("maps").at(0);
  EXPECT_EQ(map.at("name"), "map");
  EXPECT_EQ(map.at("objects"), ServeJson::parse(built.out).at("objects"));
  EXPECT_EQ(jsonOf(shared().get("/maps/map")), map);
  std::size_t counted = 0;
  for (const auto& [name, count] : map.at("objectsByClass").items()) {
    counted += count.get<std::size_t>();
    EXPECT_GE(jsonOf(shared().get("/objects?limit=0&class=" + name)).at("total"), count) << name;
  }
  EXPECT_EQ(counted, map.at("objects"));
}

TEST_F(ServeCommand, PagesOfObjectsPutTogetherAreAllObjects) {
  const ServeJson all = jsonOf(shared().get("/objects?limit=10000"));
  ServeJson pages = ServeJson::array();
  for (std::size_t offset = 0;;) {
    const ServeJson page = jsonOf(shared().get("/objects?limit=7&offset=" + std::to_string(offset)));
    for (const ServeJson& object : page.at("objects")) pages.push_back(object);
    if (!page.contains("nextOffset")) break;
    offset = page.at("nextOffset");
  }
  EXPECT_EQ(pages, all.at("objects"));
  EXPECT_EQ(all.at("total"), all.at("objects").size());
}

TEST_F(ServeCommand, ABoxSelectsTheObjectsThatMeetIt) {
  const ServeJson all = jsonOf(shared().get("/objects?limit=10000")).at("objects");
  const ServeJson near = jsonOf(shared().get("/objects?limit=10000&bbox=0,0,12,9")).at("objects");
  ServeJson expected = ServeJson::array();
  for (const ServeJson& object : all)
    if (object["min"][0] <= 12 && object["max"][0] >= 0 && object["min"][1] <= 9 && object["max"][1] >= 0)
      expected.push_back(object);
  EXPECT_EQ(near, expected);
  EXPECT_GT(near.size(), 0U);
  EXPECT_LT(near.size(), all.size());
  EXPECT_EQ(shared().get("/objects?bbox=0,0,12").status, 400);
  EXPECT_EQ(shared().get("/objects?bbox=9,0,1,2").status, 400);
  EXPECT_EQ(shared().get("/objects?class=Tre").status, 404);
  EXPECT_EQ(shared().get("/objects?class=Avenue").status, 400);
  EXPECT_NE(shared().get("/objects?class=Way&bbox=0,0,12,9").body.find("is no class of objects"), std::string::npos);
  EXPECT_EQ(jsonOf(shared().get("/objects?class=Tree&bbox=9000,0,9001,1")).at("total"), 0);
  EXPECT_EQ(shared().get("/objects?limit=-1").status, 400);
  EXPECT_EQ(shared().get("/objects?clas=Tree").status, 400);
}

TEST_F(ServeCommand, AnObjectIsExplainedAsByTheCommandExplain) {
  const ServeJson object = jsonOf(shared().get("/objects?class=Tree")).at("objects").at(0);
  const std::string id = object.at("id");
  const auto alone = [](const std::string& name) {
    ServeJson one = jsonOf(shared().get("/objects/" + name));
    EXPECT_NE(one.at("thing").get<std::string>().find("/map/thing/"), std::string::npos);
    one.erase("thing");  // the list does not tell it
    return one;
  };
  EXPECT_EQ(alone(id), object);
  EXPECT_EQ(alone(id.substr(0, 12)), object);
  EXPECT_EQ(alone("%23" + std::to_string(object.at("number").get<int>())), object);
  const std::string explain = "explain " + path("map.clx").string() + " object/" + id;
  EXPECT_EQ(shared().get("/objects/" + id + "/explanation").body, run(explain + " --json").out);
  EXPECT_EQ(shared().get("/objects/" + id + "/explanation", "Accept: text/plain\r\n").body, run(explain).out);
  const std::string why_not = "/objects/" + id + "/explanation?whyNot=";
  EXPECT_EQ(shared().get(why_not + "StreetLamp").body, run(explain + " --why-not StreetLamp --json").out);
  EXPECT_EQ(shared().get(why_not + "Spaceship").status, 404);
  EXPECT_EQ(shared().get("/objects/" + id + "/explanation?whynot=Tree").status, 400);
  EXPECT_EQ(shared().get("/objects/ffffffffffff").status, 404);
  EXPECT_EQ(shared().get("/objects/a").status, 400);
  EXPECT_EQ(shared().get("/objects/" + id + "?limit=1").status, 400);
  EXPECT_EQ(shared().get("/objects/" + id + "/points?limit=1").status, 400);
}

TEST_F(ServeCommand, PointsOfAnObjectLieInItsBox) {
  const ServeJson object = jsonOf(shared().get("/objects?class=Tree")).at("objects").at(0);
  const std::string resource = "/objects/" + object.at("id").get<std::string>() + "/points";
  const ServeJson points = jsonOf(shared().get(resource));
  ASSERT_GE(points.at("count"), object.at("pointCount"));
  for (const char* axis : {"x", "y", "z"}) {
    const int place = axis[0] - 'x';
    for (const ServeJson& value : points.at(axis)) {
      EXPECT_GE(value.get<double>(), object["min"][place].get<double>() - 0.06);
      EXPECT_LE(value.get<double>(), object["max"][place].get<double>() + 0.06);
    }
  }
  const std::string csv = shared().get(resource, "Accept: text/csv\r\n").body;
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')),
            points.at("count").get<std::size_t>() + 1);
}

TEST_F(ServeCommand, ShippedQuestionsAnswerAsTheCommandQuery) {
  const ServeJson known = jsonOf(shared().get("/questions"));
  for (const ServeJson& question : known.at("questions")) {
    const std::string name = question.at("name");
    const Reply reply = shared().get("/questions/" + name + "?format=csv");
    EXPECT_EQ(reply.status, 200) << name << reply.body;
    EXPECT_EQ(reply.body, run("query " + path("map.clx").string() + " " + name + ".rq --format csv").out) << name;
  }
  EXPECT_EQ(shared().get("/questions/near_point?format=csv&radius=25&x=3").body,
            run("query " + path("map.clx").string() + " near_point.rq --param radius=25 --param x=3 --format csv").out);
}

TEST_F(ServeCommand, TasksAnswerAsTheCommandAsk) {
  EXPECT_EQ(jsonOf(shared().get("/tasks")).at("tasks"), ServeJson::parse(run("tasks --json").out));
  const std::string map = path("map.clx").string();
  const std::vector<std::pair<std::string, std::string>> same{
      {"search?for=StreetSign&from=0,0&budget=40", "search for=StreetSign from=0,0 budget=40 --json"},
      {"search?for=StreetSign&from=0,0&why=true&format=table", "search for=StreetSign from=0,0 --why"},
      {"reach?from=0,0&minutes=0.2&without=Movable", "reach from=0,0 minutes=0.2 without=Movable --json"},
      {"near_point?radius=5&format=csv", "near_point radius=5 --format csv"},
      {"near_point?radius=5&format=csv&why=true", "near_point radius=5 --format csv --why"},
      {"costmap?format=geojson&frame=local", "costmap --geojson --local"}};
  for (const auto& [resource, command] : same)
    EXPECT_EQ(shared().get("/tasks/" + resource).body, run("ask " + map + " " + command).out) << resource;
  const ServeJson stop = jsonOf(shared().get("/tasks/search?for=StreetSign&from=0,0")).at("rows").at(0);
  const std::string to = std::to_string(stop["x"].get<double>()) + "," + std::to_string(stop["y"].get<double>());
  EXPECT_EQ(shared().get("/tasks/route?from=0,0&to=" + to).body,
            run("ask " + map + " route from=0,0 to=" + to + " --json").out);
  const Reply degrees = shared().get("/tasks/costmap?format=geojson");
  EXPECT_EQ(degrees.status, 400) << "the map has no coordinate system";
  EXPECT_NE(degrees.body.find("frame=local"), std::string::npos) << degrees.body;
  for (const char* faulty : {"route?from=0,0", "route?from=0,0&to=1,1&width=-1", "route?from=0,0&to=1,1&wdth=1",
                             "costmap?format=xml", "costmap?frame=moon", "costmap?why=maybe", "search?for="})
    EXPECT_EQ(shared().get(std::string("/tasks/") + faulty).status, 400) << faulty;
  for (const char* unknown : {"route?from=0,0&to=1e9,0", "search?for=StreetSing", "serch"})
    EXPECT_EQ(shared().get(std::string("/tasks/") + unknown).status, 404) << unknown;
}

TEST_F(ServeCommand, SeveralMapsAreToldApartByName) {
  const Served both(command("one=" + path("map.clx").string() + " " + path("three.clx").string()), path("both.log"));
  EXPECT_EQ(both.port(), 0) << "three.clx is no map";
  fs::copy_file(path("map.clx"), path("second.clx"), fs::copy_options::overwrite_existing);
  const Served two(command("one=" + path("map.clx").string() + " " + path("second.clx").string()), path("both.log"));
  EXPECT_EQ(two.get("/sparql").status, 404);
  EXPECT_EQ(two.get("/maps/one/sparql?query=ASK%7B%7D").status, 200);
  EXPECT_EQ(two.get("/maps/second/objects").status, 200);
  EXPECT_NE(two.get("/").body.find("/maps/second/sparql"), std::string::npos);
  expectError(run("serve --port 0 " + path("map.clx").string() + " " + path("map.clx").string()), 2, "NAME=FILE");
}

TEST_F(ServeCommand, NamesOfMapsAreTextInThePageAndNeverMarkup) {
  const Served served(command("'<script>x=" + path("map.clx").string() + "'"), path("markup.log"));
  const Reply page = served.get("/");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.body.find("<script"), std::string::npos);
  EXPECT_NE(page.body.find("&lt;script&gt;x"), std::string::npos);
  EXPECT_TRUE(page.has("Content-Security-Policy: default-src 'none'")) << page.head;
}

TEST_F(ServeCommand, ShowsThePageOfTheCommandView) {
  const Outcome written = run("view " + path("map.clx").string() + " -o " + path("page.html").string());
  if (written.code != 0) GTEST_SKIP() << "the page's program is not made: ./run web";
  const Served served(command(path("map.clx").string()), path("page.log"));
  const Reply page = served.get("/maps/map/page");
  ASSERT_EQ(page.status, 200);
  // The served page may ask its service, and its block "map" says so. The rest is the same.
  const std::string policy = "connect-src 'self'; ", file = readFile(path("page.html"));
  std::string body = page.body;
  ASSERT_NE(body.find(policy), std::string::npos);
  body.erase(body.find(policy), policy.size());
  const auto headOf = [](const std::string& all) { return all.substr(0, all.find("id=\"map\"")); };
  const auto dataOf = [](const std::string& all) { return all.substr(all.find("id=\"objects\"")); };
  EXPECT_TRUE(headOf(body) == headOf(file));
  EXPECT_TRUE(dataOf(body) == dataOf(file));
  EXPECT_TRUE(served.get("/maps/map/page").body == page.body);
}

TEST_F(ServeCommand, UpdatesNeedTheTokenAndReachTheOperatorsGraphOnly) {
  const std::string update = "INSERT DATA { <urn:a> <urn:b> 1 }", type = "application/sparql-update";
  EXPECT_EQ(shared().post("/sparql", type, update).status, 403) << "started without a token";
  fs::copy_file(path("map.clx"), path("written.clx"), fs::copy_options::overwrite_existing);
  writeFile(path("token"), "a token must be long\n");
  expectError(run("serve --port 0 " + path("map.clx").string() + " --token-file " + path("token").string()), 4,
              "token");
  writeFile(path("token"), "0123456789abcdef0123\n");
  const Served served = serve("--token-file " + path("token").string(), "written.clx");
  const std::string right = "Authorization: Bearer 0123456789abcdef0123\r\n";
  EXPECT_EQ(served.post("/sparql", type, update).status, 401);
  EXPECT_TRUE(served.post("/sparql", type, update).has("WWW-Authenticate: Bearer"));
  EXPECT_EQ(served.post("/sparql", type, update, "Authorization: Bearer 0123456789abcdef0124\r\n").status, 401);
  EXPECT_EQ(served.query("ASK { <urn:a> <urn:b> 1 }", "Accept: text/csv\r\n").body.find("true"), std::string::npos);
  EXPECT_EQ(served.post("/sparql", type, update, right).status, 200);
  EXPECT_NE(
      served.query("ASK { GRAPH <https://w3id.org/cluxel/graph/operator> { <urn:a> <urn:b> 1 } }").body.find("true"),
      std::string::npos);
  EXPECT_EQ(served
                .post("/sparql", "application/x-www-form-urlencoded",
                      "update=DELETE+DATA+%7B+%3Curn:a%3E+%3Curn:b%3E+1+%7D", right)
                .status,
            200);
  EXPECT_NE(served.query("ASK { <urn:a> <urn:b> 1 }").body.find("false"), std::string::npos);
  const Reply observed = served.post("/sparql", type, "CLEAR GRAPH <https://w3id.org/cluxel/graph/observed>", right);
  EXPECT_EQ(observed.status, 400);
  EXPECT_NE(observed.body.find("may not be written"), std::string::npos);
  EXPECT_EQ(
      served.post("/sparql?using-graph-uri=urn:g", type, "WITH <urn:g> DELETE { ?s ?p ?o } WHERE { ?s ?p ?o }", right)
          .status,
      400);
  const Reply load = served.post("/sparql", type, "LOAD <file:///etc/passwd>", right);
  EXPECT_EQ(load.status, 400);
  EXPECT_NE(load.body.find("send the quads by INSERT DATA"), std::string::npos) << load.body;
}

TEST_F(ServeCommand, LargeAnswersAreSentWithoutCompression) {
  const Reply plain = shared().get("/graph?default"),
              packed = shared().get("/graph?default", "Accept-Encoding: br, gzip\r\n");
  ASSERT_GT(plain.body.size(), std::size_t{1} << 20U);
  EXPECT_EQ(packed.header("Content-Encoding"), "");
  EXPECT_EQ(packed.body, plain.body);
}

TEST_F(ServeCommand, TriesPostedRulesForThoseWhoHaveTheToken) {
  const std::string own = "apiVersion: cluxel.rules/v1\ninclude: [ outdoor.rules.yaml ]\n", type = "application/yaml";
  EXPECT_EQ(shared().post("/rules/trial", type, own).status, 403) << "started without a token";
  fs::copy_file(path("map.clx"), path("tried.clx"), fs::copy_options::overwrite_existing);
  writeFile(path("token"), "0123456789abcdef0123\n");
  const Served served = serve("--token-file " + path("token").string(), "tried.clx");
  const std::string right = "Authorization: Bearer 0123456789abcdef0123\r\n";
  const Reply refused = served.post("/rules/trial", type, own);
  EXPECT_EQ(refused.status, 401);
  EXPECT_NE(refused.body.find("a trial of rules needs the service's token"), std::string::npos) << refused.body;
  EXPECT_EQ(served.get("/rules/trial").status, 405);
  EXPECT_EQ(served.post("/rules/trial", "application/json", own, right).status, 415);
  const ServeJson same = jsonOf(served.post("/rules/trial", type, own, right));
  EXPECT_TRUE(same.at("changes").empty()) << same;
  const std::string without = own + "override:\n  rules:\n    - { id: ground/patches, tree: { reject: off } }\n";
  const ServeJson other = jsonOf(served.post("/rules/trial", type, without, right));
  EXPECT_FALSE(other.at("changes").empty());
  const Reply faulty = served.post("/rules/trial", type, own + "rules: 7\n", right);
  EXPECT_EQ(faulty.status, 400);
  EXPECT_NE(faulty.body.find("posted.rules.yaml:3"), std::string::npos) << faulty.body;
}

}  // namespace
}  // namespace cluxel::app
