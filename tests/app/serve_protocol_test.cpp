// SPDX-License-Identifier: Apache-2.0
// `cluxel serve` by its sockets: the SPARQL protocol, content negotiation, and refusals.
#include <nlohmann/json.hpp>

#include "app/serve_fixture.hpp"

namespace cluxel::app {
namespace {

using ServeJson = nlohmann::json;

constexpr const char* kTrees =
    "PREFIX clx: <https://w3id.org/cluxel/ontology#> SELECT ?o WHERE { ?o a clx:Tree } ORDER BY ?o";
constexpr const char* kTreesEncoded =
    "PREFIX%20clx:%20%3Chttps://w3id.org/cluxel/ontology%23%3E%20SELECT%20?o%20WHERE%20%7B%20?o%20a%20clx:Tree%20%7D%20"
    "ORDER+BY+?o";

TEST_F(ServeCommand, GetAndBothPostsGiveTheRowsOfTheCommandQuery) {
  const std::string csv = "Accept: text/csv\r\n";
  const Outcome expected = query("map.clx", kTrees, "--format csv");
  ASSERT_EQ(expected.code, 0) << expected.err;
  for (const Reply& reply :
       {shared().get(std::string("/sparql?query=") + kTreesEncoded, csv),
        shared().post("/sparql", "application/x-www-form-urlencoded", std::string("query=") + kTreesEncoded, csv),
        shared().query(kTrees, csv), shared().get(std::string("/maps/map/sparql?query=") + kTreesEncoded, csv)}) {
    EXPECT_EQ(reply.status, 200) << reply.body;
    EXPECT_EQ(reply.body, expected.out);
  }
}

struct Negotiation {
  const char* query;
  const char* accept;
  int status;
  const char* type;
};

TEST_F(ServeCommand, TheHeaderAcceptChoosesAmongTheFormats) {
  const char *select = "SELECT * { ?s ?p ?o } LIMIT 1", *ask = "ASK {}",
             *graph = "CONSTRUCT WHERE { ?s ?p ?o } LIMIT 1";
  const char *json = "application/sparql-results+json", *xml = "application/sparql-results+xml";
  const char *turtle = "text/turtle; charset=utf-8", *csv = "text/csv; charset=utf-8";
  const std::vector<Negotiation> table{
      {select, "", 200, json},
      {select, "*/*", 200, json},
      {select, "application/json", 200, "application/json"},
      {select, "application/sparql-results+xml", 200, xml},
      {select, "application/xml", 200, "application/xml"},
      {select, "text/csv", 200, csv},
      {select, "TEXT/CSV;header=present", 200, csv},
      {select, "text/tab-separated-values", 200, "text/tab-separated-values; charset=utf-8"},
      {select, "text/plain", 200, "text/plain; charset=utf-8"},
      {select, "text/csv;q=0.5, application/sparql-results+xml;q=0.9", 200, xml},
      {select, "text/*;q=0.9, text/csv;q=0.1, */*;q=0.2", 200, "text/tab-separated-values; charset=utf-8"},
      {select, "application/sparql-results+json;q=0, application/*", 200, "application/json"},
      {select, "text/turtle, application/n-triples", 406, ""},
      {select, "image/png", 406, ""},
      {select, "*/*;q=0", 406, ""},
      {select, "nonsense, text/csv;q=2, application/xml;q=0.3", 200, "application/xml"},
      {ask, "", 200, json},
      {ask, "application/sparql-results+xml", 200, xml},
      {graph, "", 200, turtle},
      {graph, "application/n-triples", 200, "application/n-triples"},
      {graph, "application/sparql-results+json, text/turtle;q=0.1", 200, turtle},
      {graph, "application/sparql-results+json", 406, ""},
      {graph, "text/turtle;q=0.3,application/n-triples;q=0.31", 200, "application/n-triples"}};
  for (const Negotiation& row : table) {
    const std::string header = *row.accept == 0 ? "" : std::string("Accept: ") + row.accept + "\r\n";
    const Reply reply = shared().query(row.query, header);
    EXPECT_EQ(reply.status, row.status) << row.accept << "\n" << reply.body;
    if (row.status == 200) {
      EXPECT_EQ(reply.header("Content-Type"), row.type) << row.accept;
      EXPECT_TRUE(reply.has("Vary: Accept")) << reply.head;
    } else {
      EXPECT_NE(reply.body.find("can be had as"), std::string::npos) << reply.body;
    }
  }
}

TEST_F(ServeCommand, GraphsOfTheProtocolReplaceTheDataset) {
  const std::string count = "/sparql?format=csv&query=SELECT+(COUNT(*)+AS+?n)+%7B+?s+?p+?o+%7D";
  const std::string observed = "https://w3id.org/cluxel/graph/observed";
  const std::string whole = shared().get(count).body,
                    part = shared().get(count + "&default-graph-uri=" + observed).body;
  EXPECT_NE(whole, part);
  EXPECT_EQ(part, query("map.clx", "SELECT (COUNT(*) AS ?n) FROM <" + observed + "> { ?s ?p ?o }", "--format csv").out);
  EXPECT_EQ(shared().get(count + "&named-graph-uri=" + observed).body, "n\r\n0\r\n") << "the default graph is empty";
  const std::string named = "/sparql?format=csv&query=SELECT+DISTINCT+?g+%7B+GRAPH+?g+%7B+?s+?p+?o+%7D+%7D";
  EXPECT_EQ(shared().get(named + "&named-graph-uri=" + observed).body, "g\r\n" + observed + "\r\n");
}

TEST_F(ServeCommand, FaultyRequestsGetTheirStatusAndAMessage) {
  const auto expect = [](const Reply& reply, int status, const std::string& words) {
    EXPECT_EQ(reply.status, status) << reply.body;
    EXPECT_NE(reply.body.find(words), std::string::npos) << reply.body;
  };
  expect(shared().query("SELECT * {"), 400, "query:1:");
  expect(shared().get("/sparql?query=ASK%7B%7D&query=ASK%7B%7D"), 400, "more than once");
  expect(shared().get("/sparql?qery=ASK%7B%7D"), 400, "query");
  expect(shared().get("/sparql?query=%ZZ"), 400, "%25");
  expect(shared().get("/sparql?update=CLEAR+ALL"), 400, "POST");
  expect(shared().post("/sparql", "application/x-www-form-urlencoded", "query=ASK%7B%7D&update=CLEAR+ALL"), 400,
         "more than one");
  expect(shared().post("/sparql", "text/turtle", "<a:b> <a:b> 1 ."), 415, "application/sparql-query");
  expect(shared().post("/sparql", "application/sparql-query; charset=latin1", "ASK{}"), 415, "UTF-8");
  expect(shared().post("/sparql", "multipart/form-data; boundary=x", "--x--"), 415, "several parts");
  expect(shared().post("/sparql", "application/sparql-query", "ASK{}", "Content-Encoding: gzip\r\n"), 415,
         "compressed");
  expect(shared().post("/sparql", "application/sparql-query", std::string((1 << 20) + 1, ' ')), 413, "too large");
  expect(shared().post("/maps", "text/plain", "x"), 405, "GET");
  EXPECT_EQ(shared().post("/maps", "text/plain", "x").header("Allow"), "GET, HEAD");
  expect(replyOf(shared().exchange("DELETE /maps HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")), 405,
         "GET");
  expect(shared().get("/nothing"), 404, "/ lists");
  expect(shared().get("/maps/mup/sparql"), 404, "did you mean 'map'");
  expect(shared().get("/sparql?query=ASK%7B%7D&x=" + std::string(9000, 'x')), 414, "POST");
  expect(shared().get("/sparql?query=ASK%7B%7D&x=" + std::string(200'000, 'x')), 414, "POST");
  const std::string declared = "POST /sparql HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999999999\r\n";
  expect(replyOf(shared().exchange(declared + "Content-Type: application/sparql-query\r\n\r\n")), 413, "too large");
  expect(replyOf(shared().exchange("GET / HTTP/1.1\r\nHost: rebound.example\r\nConnection: close\r\n\r\n")), 421,
         "rebound.example");
  expect(shared().get("/questions/tree"), 404, "did you mean 'trees'");
  expect(shared().get("/questions/near_point?radius=wide"), 400, "radius");
  expect(shared().get("/questions/near_point?radius=5&radius=60"), 400, "radius=60: it may be given once");
  expect(shared().query("ASK{}", "X-Long: " + std::string(70'000, 'x') + "\r\n"), 431, "headers");
}

TEST_F(ServeCommand, TheLengthOfABodyIsGivenOnceAndAsANumber) {
  const std::string post = "POST /sparql HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/sparql-query\r\n";
  const auto statusOf = [&](const std::string& headers) {
    return replyOf(shared().exchange(post + headers + "\r\nASK {}")).status;
  };
  EXPECT_EQ(statusOf("Connection: close\r\nContent-Length: 6\r\n"), 200);
  EXPECT_EQ(statusOf(""), 411);
  for (const char* faulty :
       {"Content-Length: abc\r\n", "Content-Length: -6\r\n", "Content-Length: 6 x\r\n",
        "Content-Length: 6\r\nContent-Length: 0\r\n", "Content-Length: 6\r\nTransfer-Encoding: chunked\r\n",
        "Transfer-Encoding: gzip, chunked\r\n"})
    EXPECT_EQ(statusOf(faulty), 400) << faulty;
}

TEST_F(ServeCommand, TheEndOfAConnectionIsToldOnce) {
  const std::string post = "POST /sparql HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/sparql-query\r\n";
  const auto countOf = [](const std::string& answer, const std::string& name) {
    const std::string head = answer.substr(0, answer.find("\r\n\r\n"));
    std::size_t count = 0;
    for (std::size_t at = head.find(name); at != std::string::npos; at = head.find(name, at + 1)) ++count;
    return count;
  };
  for (const std::string& ending : {std::string(), std::string("Connection: close\r\n")})
    for (const char* refused : {"", "Content-Length: abc\r\n", "Content-Length: 99999999999\r\n"}) {
      const std::string answer = shared().exchange(post + ending + refused + "\r\nASK {}");
      EXPECT_EQ(countOf(answer, "\nConnection: close"), 1U) << answer;
      EXPECT_EQ(countOf(answer, "Keep-Alive"), 0U) << answer;
    }
  EXPECT_EQ(countOf(shared().exchange("GET /maps HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"),
                    "\nConnection: close"),
            1U);
}

TEST_F(ServeCommand, ATargetMayNameTheServer) {
  const auto get = [](const std::string& target) {
    return replyOf(shared().exchange("GET " + target + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"));
  };
  EXPECT_EQ(get("http://localhost/maps").body, get("/maps").body);
  EXPECT_EQ(get("http://localhost/maps").status, 200);
  EXPECT_EQ(get("http://localhost").status, 200);
  EXPECT_EQ(get("http://localhost?x=/maps").body, get("/?x=/maps").body);
}

TEST_F(ServeCommand, WarningsOfAQueryStandInHeadersAndBelowATable) {
  const std::string clx = "PREFIX clx: <https://w3id.org/cluxel/ontology#> ";
  for (const char* format : {"text/csv", "application/sparql-results+json", "text/plain"}) {
    const Reply reply = shared().query(clx + "ASK { ?s a clx:Tre }", std::string("Accept: ") + format + "\r\n");
    EXPECT_EQ(reply.status, 200);
    EXPECT_NE(reply.header("Cluxel-Warning")
                  .find("the map has no class <https://w3id.org/cluxel/ontology#Tre>; hint: "
                        "did you mean 'Tree'?"),
              std::string::npos)
        << reply.head;
    EXPECT_EQ(reply.body.find("did you mean") != std::string::npos, std::string(format) == "text/plain") << reply.body;
  }
  const auto warning = [](const std::string& query) { return shared().query(query).header("Cluxel-Warning"); };
  EXPECT_EQ(warning(clx + "ASK { ?s a clx:Tree }"), "");
  EXPECT_NE(warning("SELECT * FROM <urn:none> { ?s ?p ?o }").find("no graph <urn:none>"), std::string::npos);
  EXPECT_NE(warning("ASK { ?s <urn:stra\u00dfe%> ?o }").find("<urn:stra%C3%9Fe%25>"), std::string::npos);
  EXPECT_NE(shared().get("/sparql?query=ASK%7B?s%20?p%20?o%7D&default-graph-uri=urn:none").header("Cluxel-Warning"),
            "");
  std::string many = "ASK { ";
  for (int i = 0; i < 300; ++i) many += "?s <urn:p" + std::to_string(i) + "> ?o . ";
  const Reply reply = shared().query(many + "}");
  EXPECT_EQ(reply.status, 200);
  EXPECT_LT(reply.head.size(), 8192U);
  EXPECT_TRUE(reply.has("Cluxel-Warning: 192 further warnings")) << reply.head;
  const std::string near = readFile(test::sourceFolder() / "queries/near_point.rq");
  EXPECT_NE(warning(near).find("?x has no value here"), std::string::npos) << "its parameters have no values";
  EXPECT_EQ(shared().get("/questions/near_point").header("Cluxel-Warning"), "");
}

TEST_F(ServeCommand, TheMapsPrefixesNeedNoDeclaration) {
  const std::string csv = "Accept: text/csv\r\n", bare = "SELECT ?o WHERE { ?o a clx:Tree } ORDER BY ?o";
  const Reply reply = shared().query(bare, csv);
  EXPECT_EQ(reply.status, 200) << reply.body;
  EXPECT_EQ(reply.body, shared().query(kTrees, csv).body);
  EXPECT_EQ(shared().query("PREFIX clx: <urn:> " + bare, csv).body, "o\r\n") << "a PREFIX line overrides them";
}

TEST_F(ServeCommand, LongQueriesPassByPost) {
  const std::string query = "ASK {}" + std::string(200'000, ' ');
  EXPECT_EQ(shared().query(query).status, 200);
  EXPECT_EQ(
      shared()
          .post("/sparql", "application/x-www-form-urlencoded", "query=" + std::string(200'000, '+') + "ASK%7B%7D")
          .status,
      200);
}

TEST_F(ServeCommand, AConnectionServesManyRequestsAndHeadHasNoBody) {
  const Connection connection(shared().port());
  for (int i = 0; i < 20; ++i) connection.send("HEAD /maps HTTP/1.1\r\nHost: localhost\r\n\r\n");
  connection.send("GET /maps HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  const std::string all = connection.receiveAll();
  std::size_t responses = 0;
  for (std::size_t at = all.find("HTTP/1.1 200"); at != std::string::npos; at = all.find("HTTP/1.1 200", at + 1))
    ++responses;
  EXPECT_EQ(responses, 21U);
  EXPECT_EQ(all.find("{\"maps\""), all.rfind("{\"maps\"")) << "only GET has a body";
}

TEST_F(ServeCommand, WithoutAQueryTheEndpointDescribesItself) {
  const Reply reply = shared().get("/sparql", "Accept: text/turtle\r\n");
  ASSERT_EQ(reply.status, 200) << reply.body;
  writeFile(path("service.ttl"), reply.body);
  EXPECT_EQ(query("service.ttl",
                  "PREFIX sd: <http://www.w3.org/ns/sparql-service-description#> ASK { ?s a sd:Service ; sd:endpoint "
                  "<http://localhost/maps/map/sparql> ; sd:supportedLanguage sd:SPARQL11Query ; "
                  "sd:defaultDataset/sd:namedGraph/sd:name "
                  "<https://w3id.org/cluxel/graph/observed> . FILTER NOT EXISTS { ?s sd:supportedLanguage "
                  "sd:SPARQL11Update } }")
                .code,
            0)
      << reply.body;
}

TEST_F(ServeCommand, GraphsAreReadWhole) {
  const Reply reply =
      shared().get("/graph?graph=https://w3id.org/cluxel/graph/ontology", "Accept: application/n-triples\r\n");
  ASSERT_EQ(reply.status, 200) << reply.body;
  writeFile(path("ontology.nt"), reply.body);
  const std::string count = "SELECT (COUNT(*) AS ?n) { ?s ?p ?o }";
  EXPECT_EQ(query("ontology.nt", count, "--format csv").out,
            query("map.clx", "SELECT (COUNT(*) AS ?n) FROM <https://w3id.org/cluxel/graph/ontology> { ?s ?p ?o }",
                  "--format csv")
                .out);
  EXPECT_EQ(shared().get("/graph?graph=urn:none").status, 404);
  EXPECT_EQ(shared().get("/graph").status, 400);
}

TEST_F(ServeCommand, RangesAreIgnoredAndNotOffered) {
  const Reply whole = shared().get("/maps");
  ASSERT_EQ(whole.status, 200);
  EXPECT_TRUE(whole.header("Accept-Ranges").empty()) << whole.head;
  for (const char* range : {"Range: items=0-1", "Range: bytes=5-3", "Range: bytes=0-1", "range: bytes=9999999-",
                            "RANGE:", "Range : bytes=x", "Range: bytes=0-0,2-3\r\nRange: bytes=7-2"}) {
    const std::string header = std::string(range) + "\r\n";
    const Reply reply = shared().get("/maps", header);
    EXPECT_EQ(reply.status, 200) << range << "\n" << reply.body;
    EXPECT_EQ(reply.body, whole.body) << range;
    EXPECT_FALSE(reply.has("Content-Range") || reply.has("Accept-Ranges")) << reply.head;
    const Reply posted = shared().query("ASK { ?s ?p ?o }", header + "Accept: text/csv\r\n");
    EXPECT_EQ(posted.status, 200) << range << "\n" << posted.body;
    EXPECT_NE(posted.body.find("true"), std::string::npos) << posted.body;
  }
  const std::string beside = "X-Range: a\r\nRanges: b\r\nAccept: text/csv\r\n";
  EXPECT_EQ(shared().query("ASK {}", beside).header("Content-Type"), "text/csv; charset=utf-8");
  const Reply head = replyOf(shared().exchange("HEAD /maps HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"));
  EXPECT_EQ(head.status, 200);
  EXPECT_FALSE(head.has("Accept-Ranges")) << head.head;
}

TEST_F(ServeCommand, OtherOriginsReadAnswersOnlyWhenAllowed) {
  const std::string origin = "Origin: https://maps.example\r\n";
  EXPECT_FALSE(shared().get("/maps", origin).has("Access-Control-"));
  const Served open = serve("--cors https://maps.example");
  EXPECT_EQ(open.get("/maps", origin).header("Access-Control-Expose-Headers"), "Cluxel-Warning, Cluxel-State");
  EXPECT_EQ(open.get("/maps", origin).header("Access-Control-Allow-Origin"), "https://maps.example");
  EXPECT_FALSE(open.get("/maps", "Origin: https://other.example\r\n").has("Access-Control-Allow-Origin"));
  const Reply asked = replyOf(open.exchange("OPTIONS /sparql HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" +
                                            origin + "Access-Control-Request-Method: POST\r\n\r\n"));
  EXPECT_EQ(asked.status, 204);
  EXPECT_TRUE(asked.has("Access-Control-Allow-Methods: GET, HEAD, POST")) << asked.head;
}

TEST_F(ServeCommand, CurlGetsTheSame) {
  if (std::system("command -v curl > /dev/null") != 0) GTEST_SKIP() << "no curl here";
  const std::string out = path("curl.csv").string();
  const std::string url = "http://127.0.0.1:" + std::to_string(shared().port()) + "/sparql";
  for (const std::string& way : {std::string("--data-urlencode"), std::string("-G --data-urlencode")}) {
    const std::string command =
        "curl -sSf -H 'Accept: text/csv' " + way + " 'query=" + kTrees + "' -o " + out + " " + url;
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    EXPECT_EQ(readFile(out), query("map.clx", kTrees, "--format csv").out);
  }
}

}  // namespace
}  // namespace cluxel::app
