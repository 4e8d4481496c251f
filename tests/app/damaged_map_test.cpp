// SPDX-License-Identifier: Apache-2.0
// Damages a map at random and runs the commands on it: each gives the answer of the undamaged map, or an error with its
// exit code; never a signal, and never another answer.
#include <gmock/gmock.h>

#include <map>
#include <random>

#include "app/program_fixture.hpp"

namespace cluxel::app {
namespace {

/// A command line with MAP for the file, and one that shows what a writing command left.
struct Action {
  std::string name, arguments, then;
};

struct Tally {
  int same = 0, refused = 0, killed = 0, differs = 0;
};

class DamagedMap : public Program {
 protected:
  static void SetUpTestSuite() {
    Program::SetUpTestSuite();
    // Commits after the build leave free pages with old contents, and a value of more than a page.
    const std::string map = path("map.clx").string();
    for (int i = 0; i < 6; ++i)
      run("update " + map + " -e 'INSERT DATA { <http://x/" + std::to_string(i) + "> <http://x/p> \"" +
          std::string(3000, 'x') + "\", " + std::to_string(i) + " }'");
    run("update " + map +
        " -e 'DELETE WHERE { GRAPH <https://w3id.org/cluxel/graph/operator> { <http://x/3> ?p ?o } }'");
    sound() = readFile(map);
  }

  static std::string& sound() {
    static std::string bytes;
    return bytes;
  }

  static std::vector<Action> actions() {
    const auto asked = [](const std::string& name, const std::string& text) {
      return Action{name, "query MAP --format csv -e '" + text + "'", ""};
    };
    return {asked("query one", "SELECT ?p ?o { <http://x/1> ?p ?o } ORDER BY ?p ?o"),
            asked("query all", "SELECT * { GRAPH ?g { ?s ?p ?o } } ORDER BY ?g ?s ?p ?o"),
            asked("query near",
                  "SELECT ?a ?b { ?a geo:hasCentroid/geo:asWKT ?g . ?b geo:hasCentroid/geo:asWKT ?h "
                  "FILTER(geof:distance(?g, ?h) < 5) } ORDER BY ?a ?b"),
            asked("query counts", "SELECT ?c (COUNT(*) AS ?n) { ?s a ?c } GROUP BY ?c ORDER BY ?c"),
            {"export canonical", "export MAP --canonical", ""},
            {"export ply", "export MAP --format ply", ""},
            {"info", "info MAP", ""},
            {"explain", "explain MAP 1", ""},
            {"doctor", "doctor MAP", ""},
            {"update", "update MAP -e 'INSERT DATA { <http://x/new> <http://x/p> 7 }'", "export OUT --format nquads"},
            {"state", "state MAP --object 1 --label Seen --author somebody", "export OUT --canonical"},
            {"compact", "compact MAP", "export OUT --format nquads"}};
  }

  /// Runs the action on `bytes`; the exit code and the output, with the exit code of a signal as 128 and more.
  static std::pair<int, std::string> outcomeOf(const Action& action, const std::string& bytes) {
    const std::string file = path("damaged.clx").string();
    writeFile(file, bytes);
    fs::remove(file + "-lock");
    const auto on = [&](std::string arguments, const std::string& mark) {
      return run(arguments.replace(arguments.find(mark), mark.size(), file));
    };
    Outcome first = on(action.arguments, "MAP");
    if (action.name == "compact" || action.name == "state") first.out.clear();  // sizes of the file, names by time
    if (first.code != 0 || action.then.empty()) return {first.code, first.out};
    const Outcome after = on(action.then, "OUT");
    return {after.code, first.out + after.out};
  }

  static std::string damaged(std::mt19937& random) {
    std::string bytes = sound();
    const std::size_t at = random() % bytes.size();
    constexpr std::size_t page = 4096;
    switch (random() % 20) {
      case 0:
        return bytes.substr(0, at);
      case 1:
        std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at / page * page), page, '\0');
        return bytes;
      case 2:
        for (std::size_t i = at; i < std::min(at + 8, bytes.size()); ++i) bytes[i] = static_cast<char>(random());
        return bytes;
      default:
        bytes[at] = static_cast<char>(bytes[at] ^ (1U << (random() % 8)));
        return bytes;
    }
  }
};

TEST_F(DamagedMap, GivesTheSameAnswerOrAnError) {
  ASSERT_EQ(built.code, 0) << built.err;
  const int rounds = std::getenv("CLUXEL_LONG_TESTS") != nullptr ? 1000 : 6;
  std::map<std::string, std::pair<int, std::string>> expected;
  for (const Action& action : actions()) {
    expected[action.name] = outcomeOf(action, sound());
    ASSERT_EQ(expected[action.name].first, 0) << action.name;
  }
  std::map<std::string, Tally> tallies;
  for (int i = 0; i < rounds; ++i) {
    std::mt19937 random(static_cast<unsigned>(i));
    const std::string bytes = damaged(random);
    for (const Action& action : actions()) {
      const auto [code, out] = outcomeOf(action, bytes);
      Tally& tally = tallies[action.name];
      const bool may_find = action.name == "doctor" && code == 1;
      const bool is_same = code == 0 && out == expected[action.name].second;
      ++(is_same                  ? tally.same
         : code == 5 || may_find  ? tally.refused
         : code < 0 || code > 127 ? tally.killed
                                  : tally.differs);
      if (!is_same && code != 5 && !may_find)
        ADD_FAILURE() << action.name << " with damage " << i << " ended with code " << code << "\n"
                      << readFile(path("stderr"));
    }
  }
  int same = 0;
  for (const auto& [name, tally] : tallies) {
    std::printf("%-18s same %4d, refused %4d, killed %4d, different %4d\n", name.c_str(), tally.same, tally.refused,
                tally.killed, tally.differs);
    same += tally.same;
  }
  EXPECT_GT(same, 0) << "no question reads every byte";
  EXPECT_GT(tallies["doctor"].refused, 0) << "doctor reads most of them";
}

}  // namespace
}  // namespace cluxel::app
