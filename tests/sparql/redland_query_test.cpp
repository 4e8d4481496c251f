// SPDX-License-Identifier: Apache-2.0
// The engine through librdf alone: as registered languages, and as a module that stock tools load.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <librdf.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "cluxel/knowledge/redland_storage.hpp"
#include "cluxel/sparql/redland_query.hpp"
#include "sparql/store_fixture.hpp"

namespace cluxel::test {
namespace {

namespace fs = std::filesystem;

const unsigned char* bytes(const char* text) {
  return reinterpret_cast<const unsigned char*>(text);
}

class RedlandQueries : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("cluxel_redland_query_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    world_ = librdf_new_world();
    librdf_world_open(world_);
    librdf_world_set_logger(world_, &messages_, [](void* list, librdf_log_message* message) {
      static_cast<std::vector<std::string>*>(list)->push_back(librdf_log_message_message(message));
      return 1;
    });
    registerRedlandStorage(world_);
    ASSERT_TRUE(registerRedlandQueries(world_));
    storage_ = librdf_new_storage(world_, "cluxel", (folder_ / "map.clx").c_str(), "new='yes'");
    ASSERT_NE(storage_, nullptr);
    model_ = librdf_new_model(world_, storage_, nullptr);
    add("tree", "near", "sign");
    add("lamp", "near", "lamp");
    add("sign", "isA", "Sign");
  }
  void TearDown() override {
    librdf_free_model(model_);
    librdf_free_storage(storage_);
    librdf_free_world(world_);
    fs::remove_all(folder_);
  }
  librdf_node* node(const char* name) {
    return librdf_new_node_from_uri_string(world_, bytes((std::string("http://e/") + name).c_str()));
  }
  void add(const char* s, const char* p, const char* o) { librdf_model_add(model_, node(s), node(p), node(o)); }
  librdf_query_results* ask(const char* language, const char* text) {
    query_ = librdf_new_query(world_, language, nullptr, bytes(text), nullptr);
    return query_ == nullptr ? nullptr : librdf_model_query_execute(model_, query_);
  }
  void done(librdf_query_results* results) {
    if (results != nullptr) librdf_free_query_results(results);
    if (query_ != nullptr) librdf_free_query(query_);
    query_ = nullptr;
  }

  fs::path folder_;
  std::vector<std::string> messages_;
  librdf_world* world_ = nullptr;
  librdf_storage* storage_ = nullptr;
  librdf_model* model_ = nullptr;
  librdf_query* query_ = nullptr;
};

const char* const kNotExists =
    "PREFIX : <http://e/> SELECT ?x WHERE { ?x :near ?y FILTER NOT EXISTS { ?y :isA :Sign } }";

TEST_F(RedlandQueries, AnswerANotExistsQuestion) {
  librdf_query_results* results = ask("cluxel", kNotExists);
  ASSERT_NE(results, nullptr);
  EXPECT_TRUE(librdf_query_results_is_bindings(results));
  ASSERT_FALSE(librdf_query_results_finished(results));
  EXPECT_EQ(librdf_query_results_get_bindings_count(results), 1);
  EXPECT_STREQ(librdf_query_results_get_binding_name(results, 0), "x");
  librdf_node* value = librdf_query_results_get_binding_value_by_name(results, "x");
  ASSERT_NE(value, nullptr);
  EXPECT_STREQ(reinterpret_cast<char*>(librdf_uri_as_string(librdf_node_get_uri(value))), "http://e/lamp");
  librdf_free_node(value);
  EXPECT_NE(librdf_query_results_next(results), 0);
  EXPECT_TRUE(librdf_query_results_finished(results));
  done(results);
}

TEST_F(RedlandQueries, GiveGraphsBooleansAndFormattedText) {
  librdf_query_results* graph = ask("sparql11", "CONSTRUCT { ?o <http://e/far> ?s } WHERE { ?s <http://e/near> ?o }");
  ASSERT_NE(graph, nullptr);
  ASSERT_TRUE(librdf_query_results_is_graph(graph));
  librdf_stream* stream = librdf_query_results_as_stream(graph);
  int count = 0;
  for (; librdf_stream_end(stream) == 0; librdf_stream_next(stream)) {
    ASSERT_NE(librdf_stream_get_object(stream), nullptr);
    ++count;
  }
  EXPECT_EQ(count, 2);
  librdf_free_stream(stream);
  done(graph);

  librdf_query_results* truth = ask("cluxel", "ASK { ?s <http://e/near>+ ?s }");
  ASSERT_NE(truth, nullptr);
  EXPECT_TRUE(librdf_query_results_is_boolean(truth));
  EXPECT_EQ(librdf_query_results_get_boolean(truth), 1);
  done(truth);

  librdf_query_results* table = ask("cluxel", kNotExists);
  ASSERT_NE(table, nullptr);
  unsigned char* text = librdf_query_results_to_string2(table, "csv", nullptr, nullptr, nullptr);
  ASSERT_NE(text, nullptr);
  EXPECT_THAT(reinterpret_cast<char*>(text), testing::HasSubstr("http://e/lamp"));
  librdf_free_memory(text);
  done(table);
}

TEST_F(RedlandQueries, UpdateTheOperatorGraphOfTheMap) {
  librdf_query_results* results = ask("cluxel-update", "INSERT DATA { <http://e/lamp> <http://e/note> \"dark\" }");
  ASSERT_NE(results, nullptr);
  EXPECT_EQ(librdf_query_results_get_boolean(results), 1);
  done(results);
  librdf_query_results* seen = ask(
      "cluxel", "ASK { GRAPH <https://w3id.org/cluxel/graph/operator> { <http://e/lamp> <http://e/note> \"dark\" } }");
  ASSERT_NE(seen, nullptr);
  EXPECT_EQ(librdf_query_results_get_boolean(seen), 1);
  done(seen);
}

TEST_F(RedlandQueries, TellTheLoggerOfFaultyQueries) {
  EXPECT_EQ(ask("cluxel", "SELECT ?x WHERE { ?x "), nullptr);
  done(nullptr);
  ASSERT_FALSE(messages_.empty());
  EXPECT_THAT(messages_.back(), testing::HasSubstr("expected"));
}

TEST_F(RedlandQueries, AskModelsOfOtherStoragesToo) {
  librdf_storage* memory = librdf_new_storage(world_, "memory", nullptr, nullptr);
  librdf_model* model = librdf_new_model(world_, memory, nullptr);
  librdf_model_add(model, node("a"), node("b"), node("c"));
  librdf_query* query =
      librdf_new_query(world_, "cluxel", nullptr, bytes("ASK { <http://e/a> !<http://e/x> <http://e/c> }"), nullptr);
  librdf_query_results* results = librdf_model_query_execute(model, query);
  ASSERT_NE(results, nullptr);
  EXPECT_EQ(librdf_query_results_get_boolean(results), 1);
  librdf_free_query_results(results);
  librdf_free_query(query);
  librdf_free_model(model);
  librdf_free_storage(memory);
}

TEST_F(RedlandQueries, AreAskedByAProgramThatKnowsOnlyLibrdf) {
#ifdef CLUXEL_SANITIZED
  GTEST_SKIP() << "a program without a sanitizer cannot load a module that wants its runtime";
#endif
  const fs::path program = fs::path(CLUXEL_BINARY_DIR) / "tests/sparql/librdf_only";
  const fs::path output = folder_ / "answer";
  const std::string command = "REDLAND_MODULE_PATH='" + (fs::path(CLUXEL_BINARY_DIR) / "redland").string() + "' '" +
                              program.string() + "' '" + (folder_ / "map.clx").string() + "' '" + kNotExists + "' > '" +
                              output.string() + "' 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::ifstream in(output);
  EXPECT_EQ(std::string((std::istreambuf_iterator<char>(in)), {}), "http://e/lamp\n");
}

TEST_F(RedlandQueries, AreAskedByStockRdfproc) {
#ifdef CLUXEL_SANITIZED
  GTEST_SKIP() << "a program without a sanitizer cannot load a module that wants its runtime";
#endif
  const fs::path modules = fs::path(CLUXEL_BINARY_DIR) / "redland";
  ASSERT_TRUE(fs::exists(modules / "librdf_storage_cluxel.so")) << "the module was not built";
  if (std::system("command -v rdfproc >/dev/null") != 0) GTEST_SKIP() << "rdfproc (redland-utils) is not installed";
  const std::string output = (folder_ / "answer").string();
  const std::string command = "REDLAND_MODULE_PATH='" + modules.string() + "' rdfproc -q -s cluxel '" +
                              (folder_ / "map.clx").string() + "' query cluxel - '" + kNotExists + "' > '" + output +
                              "' 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::ifstream in(output);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  EXPECT_THAT(text, testing::HasSubstr("http://e/lamp"));
}

}  // namespace
}  // namespace cluxel::test
