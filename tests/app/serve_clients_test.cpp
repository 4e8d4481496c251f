// SPDX-License-Identifier: Apache-2.0
// Clients that others wrote: the npm package @comunica/query-sparql.
#include <nlohmann/json.hpp>

#include "app/serve_fixture.hpp"

namespace cluxel::app {
namespace {

class ServeClients : public ServeCommand {};

/// The rows of a JSON result, as the script writes them.
nlohmann::json rowsOf(const std::string& result) {
  nlohmann::json rows = nlohmann::json::array();
  const auto parsed = nlohmann::json::parse(result);
  for (const auto& binding : parsed.at("results").at("bindings")) {
    nlohmann::json row = nlohmann::json::object();
    for (const auto& [variable, term] : binding.items()) row[variable] = term.at("value");
    rows.push_back(row);
  }
  return rows;
}

TEST_F(ServeClients, ComunicaGetsTheRowsOfTheCommandQuery) {
  const fs::path modules = test::sourceFolder() / "build/npm-endpoint";
  if (std::system("command -v node > /dev/null") != 0 || !fs::exists(modules / "node_modules/@comunica/query-sparql"))
    GTEST_SKIP() << "outside data absent: node and the npm package @comunica/query-sparql (./run test installs them)";
  const std::string clx = "PREFIX clx: <https://w3id.org/cluxel/ontology#> ";
  const std::vector<std::string> selects{
      clx + "SELECT ?o ?h WHERE { ?o a clx:Tree ; clx:height ?h } ORDER BY ?o",
      clx + "SELECT ?c (COUNT(?o) AS ?n) WHERE { ?o a ?c ; clx:confidence ?p } GROUP BY ?c ORDER BY ?c",
      clx +
          "SELECT ?o WHERE { ?o clx:height ?h FILTER(?h > 4) OPTIONAL { ?o clx:hasPart ?p } } ORDER BY ?o ?p LIMIT 20"};
  nlohmann::json queries = selects;
  queries.push_back(clx + "ASK { ?o a clx:Tree }");
  queries.push_back(clx + "ASK { ?o a clx:NoSuchClass }");
  queries.push_back(clx + "CONSTRUCT { ?o clx:height ?h } WHERE { ?o a clx:Tree ; clx:height ?h }");
  writeFile(path("queries.json"), queries.dump());
  const std::string endpoint = "http://127.0.0.1:" + std::to_string(shared().port()) + "/sparql";
  const std::string command = "node " + (test::sourceFolder() / "tests/app/comunica_answers.mjs").string() + " " +
                              modules.string() + " " + endpoint + " " + path("queries.json").string() + " " +
                              path("answers.json").string();
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  const auto answers = nlohmann::json::parse(readFile(path("answers.json")));
  for (std::size_t i = 0; i < selects.size(); ++i) {
    const nlohmann::json rows = rowsOf(query("map.clx", selects[i], "--json").out);
    EXPECT_EQ(answers.at(i), rows) << selects[i];
    EXPECT_GT(rows.size(), 0U) << selects[i];
  }
  EXPECT_EQ(answers.at(3), true);
  EXPECT_EQ(answers.at(4), false);
  EXPECT_EQ(answers.at(5), answers.at(0).size());
}

}  // namespace
}  // namespace cluxel::app
