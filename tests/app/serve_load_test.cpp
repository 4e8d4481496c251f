// SPDX-License-Identifier: Apache-2.0
// `cluxel serve` under load and attack: limits, a map that grows, hostile bytes, and how it stops.
#include <future>
#include <random>
#include <set>

#include "app/serve_fixture.hpp"

namespace cluxel::app {
namespace {

/// Takes longer than any deadline here.
constexpr const char* kEndless =
    "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i FILTER(?c != ?f && ?i != ?a) }";

double secondsOf(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

TEST_F(ServeCommand, AQueryEndsAtItsLimits) {
  const Served served = serve("--deadline 0.3 --max-rows 1000 --max-answer 1");
  Reply reply;
  EXPECT_LT(secondsOf([&] { reply = served.query(kEndless); }), 20);
  EXPECT_EQ(reply.status, 503);
  EXPECT_NE(reply.body.find("budget of time"), std::string::npos) << reply.body;
  const Reply rows = served.query("SELECT * { ?s ?p ?o }");
  EXPECT_EQ(rows.status, 503);
  EXPECT_NE(rows.body.find("budget of rows"), std::string::npos) << rows.body;
  EXPECT_EQ(served.get("/graph?default").status, 503) << "more than a MiB";
  EXPECT_EQ(served.query("ASK {}").status, 200);
}

TEST_F(ServeCommand, AFullQueueIsToldWithRetryAfter) {
  const Served served = serve("--deadline 2 --running 1 --queue 0");
  auto slow = std::async(std::launch::async, [&] { return served.query(kEndless); });
  Reply refused;
  for (int i = 0; i < 100 && refused.status != 503; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    refused = served.query("ASK {}");
  }
  EXPECT_EQ(refused.status, 503);
  EXPECT_TRUE(refused.has("Retry-After: 1")) << refused.head;
  EXPECT_EQ(slow.get().status, 503) << "by its deadline";
  EXPECT_EQ(served.query("ASK {}").status, 200);
}

std::string requestOf(const std::string& query) {
  return "POST /sparql HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/sparql-query\r\nContent-Length: " +
         std::to_string(query.size()) + "\r\n\r\n" + query;
}

TEST_F(ServeCommand, AClientThatHangsUpFreesItsSlot) {
  const fs::path log = path("left.log");
  const Served served = serve("--deadline 60 --running 1 --queue 1 --log " + log.string());
  {
    const Connection running(served.port());
    running.send(requestOf(kEndless));
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    const Connection waiting(served.port());
    waiting.send(requestOf(kEndless));
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    EXPECT_EQ(served.query("ASK {}").status, 503) << "one runs, one waits";
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  Reply reply;
  EXPECT_LT(secondsOf([&] { reply = served.query("ASK {}"); }), 5);
  EXPECT_EQ(reply.status, 200) << reply.body;
  const std::string text = readFile(log);
  EXPECT_NE(text.find("\" 499 "), std::string::npos) << text;
}

TEST_F(ServeCommand, AClientThatAsksTooOftenWaits) {
  const Served served = serve("--rate 5");
  std::multiset<int> statuses;
  for (int i = 0; i < 30; ++i) statuses.insert(served.get("/maps").status);
  EXPECT_GE(statuses.count(200), 10U);
  EXPECT_GE(statuses.count(429), 1U);
  EXPECT_EQ(statuses.count(200) + statuses.count(429), 30U);
}

TEST_F(ServeCommand, TooManyConnectionsAreRefusedAndOthersGoOn) {
  const Served served = serve("--connections 3");
  const Connection a(served.port()), b(served.port()), c(served.port());
  for (const Connection* held : {&a, &b, &c}) held->send("GET /maps HTTP/1.1\r\n");
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(replyOf(Connection(served.port()).receiveAll()).status, 503);
  a.send("Host: localhost\r\nConnection: close\r\n\r\n");
  EXPECT_EQ(replyOf(a.receiveAll()).status, 200);
}

TEST_F(ServeCommand, EachAnswerIsOfOneStateWhileAnotherProcessExtendsTheMap) {
  const std::string map = path("growing.clx").string(),
                    question =
                        "PREFIX clx: <https://w3id.org/cluxel/ontology#> SELECT (COUNT(*) AS ?n) (SUM(?c) AS ?points) "
                        "{ ?o clx:confidence ?x ; "
                        "clx:pointCount ?c }";
  ASSERT_EQ(run("build " + path("campus").string() + " -o " + map + " --force").code, 0);
  const std::string whole = query("growing.clx", question, "--format csv").out;
  const std::string clouds = run("info " + map + " --clouds --json").out;
  const std::size_t id = clouds.find("\"id\": \"");
  ASSERT_NE(id, std::string::npos) << clouds;
  ASSERT_EQ(run("retract " + map + " " + clouds.substr(id + 7, 32)).code, 0);
  const std::string part = query("growing.clx", question, "--format csv").out;
  ASSERT_NE(whole, part);
  const Served served = serve("", "growing.clx");
  std::set<std::string> seen{served.query(question, "Accept: text/csv\r\n").body};
  auto extended = std::async(std::launch::async, [&] {
    return std::system((program() + "extend " + map + " " + path("campus").string() + " > /dev/null 2>&1").c_str());
  });
  while (extended.wait_for(std::chrono::milliseconds(1)) != std::future_status::ready) {
    const Reply reply = served.query(question, "Accept: text/csv\r\n");
    ASSERT_EQ(reply.status, 200) << reply.body;
    seen.insert(reply.body);
  }
  EXPECT_EQ(extended.get(), 0);
  seen.insert(served.query(question, "Accept: text/csv\r\n").body);
  EXPECT_EQ(seen, (std::set<std::string>{part, whole}));
  ASSERT_EQ(run("build " + path("campus").string() + " -o " + map + " --force").code, 0);
  EXPECT_EQ(served.query(question, "Accept: text/csv\r\n").body, whole) << "the file was replaced";
}

TEST_F(ServeCommand, ASignalLetsRequestsInFlightFinish) {
  for (const int number : {SIGTERM, SIGINT}) {
    Served served = serve("--deadline 1.5");
    const Connection idle(served.port());
    idle.send("GET /maps HTTP/1.1\r\nHost: localhost\r\n\r\n");
    auto slow = std::async(std::launch::async, [&] { return served.query(kEndless); });
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    int code = -1;
    const double took_s = secondsOf([&] { code = served.stop(number); });
    EXPECT_EQ(code, 0);
    EXPECT_EQ(slow.get().status, 503) << "the whole answer came, which is that its time was over";
    EXPECT_LT(took_s, 10);
    EXPECT_FALSE(Connection(served.port()).isOpen());
  }
}

TEST_F(ServeCommand, AnIdleServerStopsAtOnceAndAFreePortIsNeeded) {
  Served served = serve();
  const Connection idle(served.port());
  idle.send("GET /maps HTTP/1.1\r\nHost: localhost\r\n\r\n");
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  expectError(run("serve " + path("map.clx").string() + " --port " + std::to_string(served.port())), 2, "port");
  EXPECT_LT(secondsOf([&] { EXPECT_EQ(served.stop(SIGTERM), 0); }), 3);
}

TEST_F(ServeCommand, TheAccessLogHasALineForEachRequest) {
  const std::string log = path("access.log").string();
  Served served = serve("--log " + log);
  served.get("/maps?a=%22%0A");
  served.get("/nothing");
  EXPECT_EQ(served.stop(SIGTERM), 0);
  const std::string text = readFile(log);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2) << text;
  EXPECT_NE(text.find("127.0.0.1 \"GET /nothing\" 404"), std::string::npos) << text;
}

TEST_F(ServeCommand, AnAccessLogThatCannotBeWrittenIsToldOnce) {
  Served served = serve("--log /dev/full");
  EXPECT_EQ(served.get("/maps").status, 200);
  EXPECT_EQ(served.get("/maps").status, 200);
  EXPECT_EQ(served.stop(SIGTERM), 0);
  const std::string text = readFile(path("serve.log")), note = "/dev/full: the access log cannot be written";
  EXPECT_NE(text.find(note), std::string::npos) << text;
  EXPECT_EQ(text.find(note), text.rfind(note)) << text;
}

/// Requests of which pieces are lost, repeated or replaced.
std::string damaged(std::string bytes, std::mt19937& random) {
  const auto below = [&random](std::size_t n) { return random() % std::max<std::size_t>(n, 1); };
  for (std::size_t edits = 1 + below(8); edits > 0 && !bytes.empty(); --edits) {
    const std::size_t at = below(bytes.size()), length = below(12);
    switch (below(4)) {
      case 0:
        bytes.erase(at, length);
        break;
      case 1:
        bytes.insert(at, bytes.substr(below(bytes.size()), length));
        break;
      case 2:
        bytes[at] = static_cast<char>(below(256));
        break;
      default:
        bytes.resize(at);
    }
  }
  return bytes;
}

TEST_F(ServeCommand, HostileBytesNeverEndTheServer) {
  Served served = serve("--deadline 1 --quiet");
  const std::vector<std::string> valid{
      "GET /sparql?query=ASK%7B%7D HTTP/1.1\r\nHost: localhost\r\nAccept: text/csv;q=0.5, */*\r\n\r\n",
      "POST /sparql HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/sparql-query\r\nContent-Length: "
      "6\r\n\r\nASK {}",
      "POST /sparql HTTP/1.1\r\nHost: localhost\r\nContent-Type: "
      "application/x-www-form-urlencoded\r\nTransfer-Encoding: "
      "chunked\r\n\r\n5\r\nquery\r\n7\r\n=ASK+{}\r\n0\r\n\r\n",
      "GET /objects?bbox=0,0,1,1&limit=3 HTTP/1.1\r\nHost: localhost\r\nRange: bytes=0-1,3-4\r\nExpect: "
      "100-continue\r\n\r\n"};
  std::mt19937 random(7);
  const int count = std::getenv("CLUXEL_LONG_TESTS") != nullptr ? 20'000 : 1'500;
  for (int i = 0; i < count; ++i) {
    std::string bytes =
        i % 5 == 0 ? std::string(random() % 600, '\0') : damaged(valid[random() % valid.size()], random);
    if (i % 5 == 0)
      for (char& c : bytes) c = static_cast<char>(random() % 256);
    const Connection connection(served.port());
    ASSERT_TRUE(connection.isOpen()) << i;
    connection.send(bytes);
    connection.endSending();
    connection.receiveAll(3000);
    ASSERT_TRUE(served.isRunning()) << "ended by: " << bytes;
  }
  EXPECT_EQ(served.query("ASK {}").status, 200);
}

TEST_F(ServeCommand, EndlessAndHugeRequestsAreCutOff) {
  const Served served = serve("--quiet --deadline 5");
  const std::string head = "GET /maps HTTP/1.1\r\nHost: localhost\r\n";
  const std::vector<std::string> huge{std::string(1 << 20, 'x'),
                                      "GET /" + std::string(200'000, 'x') + " HTTP/1.1\r\n\r\n",
                                      head + "X: " + std::string(1 << 20, 'x'),
                                      head + "Range: bytes=" + std::string(8000, '1') + "-\r\n\r\n",
                                      head + "Range: bytes=" +
                                          [] {
                                            std::string list = "0-0";
                                            while (list.size() < 8000) list += ",0-0";
                                            return list;
                                          }() +
                                          "\r\n\r\n",
                                      head +
                                          [] {
                                            std::string lines;
                                            for (int i = 0; i < 30'000; ++i)
                                              lines += "A" + std::to_string(i) + ": b\r\n";
                                            return lines;
                                          }() +
                                          "\r\n"};
  for (const std::string& bytes : huge) {
    const Connection connection(served.port());
    connection.send(bytes);
    connection.endSending();
    connection.receiveAll(5000);
    EXPECT_EQ(served.query("ASK {}").status, 200) << bytes.substr(0, 60);
  }
}

}  // namespace
}  // namespace cluxel::app
