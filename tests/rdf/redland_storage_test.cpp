// SPDX-License-Identifier: Apache-2.0
// Tests the storage "cluxel" through librdf's API and as a module of the unmodified rdfproc.
#include "rdf/redland/redland_storage.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <librdf.h>

#include <cstdio>
#include <filesystem>

#include "base/file_bytes.hpp"
#include "rdf/redland/redland_nodes.hpp"
#include "rdf/scratch_folder.hpp"
#include "rdf/store/quad_store.hpp"
#include "rdf/vocabulary.hpp"
#include "test_paths.hpp"

namespace cluxel::rdf {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::UnorderedElementsAre;

struct WorldDeleter {
  void operator()(librdf_world* world) const { librdf_free_world(world); }
  void operator()(librdf_storage* storage) const { librdf_free_storage(storage); }
  void operator()(librdf_model* model) const { librdf_free_model(model); }
  void operator()(librdf_stream* stream) const { librdf_free_stream(stream); }
  void operator()(librdf_iterator* iterator) const { librdf_free_iterator(iterator); }
};
template <typename T>
using Handle = std::unique_ptr<T, WorldDeleter>;

int keepMessage(void* messages, librdf_log_message* message) {
  static_cast<std::vector<std::string>*>(messages)->emplace_back(librdf_log_message_message(message));
  return 1;
}

class RedlandStorage : public testing::Test {
 protected:
  void SetUp() override {
    world_.reset(librdf_new_world());
    librdf_world_open(world_.get());
    librdf_world_set_logger(world_.get(), &messages_, keepMessage);
    registerRedlandStorage(world_.get());
    openWith("new='yes'");
    ASSERT_TRUE(model_);
  }

  void openWith(const char* options) {
    close();
    storage_.reset(librdf_new_storage(world_.get(), "cluxel", file_.c_str(), options));
    if (storage_) model_.reset(librdf_new_model(world_.get(), storage_.get(), nullptr));
  }

  void close() {
    model_.reset();
    storage_.reset();
  }

  Redland<librdf_node> node(const Term& term) { return nodeOf(world_.get(), TermView::of(term)); }

  Redland<librdf_statement> statement(const std::optional<Term>& s, const std::optional<Term>& p,
                                      const std::optional<Term>& o) {
    const auto made = [&](const std::optional<Term>& term) { return term ? node(*term).release() : nullptr; };
    return Redland<librdf_statement>(librdf_new_statement_from_nodes(world_.get(), made(s), made(p), made(o)));
  }

  int add(const Term& s, const Term& p, const Term& o, const char* graph = nullptr) {
    const auto made = statement(s, p, o);
    if (graph == nullptr) return librdf_model_add_statement(model_.get(), made.get());
    const auto context = node(Term::iri(graph));
    return librdf_model_context_add_statement(model_.get(), context.get(), made.get());
  }

  std::vector<std::string> drain(librdf_stream* raw) {
    const Handle<librdf_stream> stream(raw);
    std::vector<std::string> lines;
    for (; stream && librdf_stream_end(stream.get()) == 0; librdf_stream_next(stream.get())) {
      librdf_statement* found = librdf_stream_get_object(stream.get());
      librdf_node* context = librdf_stream_get_context2(stream.get());
      lines.push_back(
          toNQuads({termOf(librdf_statement_get_subject(found)), termOf(librdf_statement_get_predicate(found)),
                    termOf(librdf_statement_get_object(found)), context != nullptr ? termOf(context) : Term::iri("")}));
    }
    return lines;
  }

  std::vector<std::string> find(const std::optional<Term>& s, const std::optional<Term>& p,
                                const std::optional<Term>& o) {
    const auto pattern = statement(s, p, o);
    return drain(librdf_model_find_statements(model_.get(), pattern.get()));
  }

  std::vector<std::string> drain(librdf_iterator* raw) {
    const Handle<librdf_iterator> iterator(raw);
    std::vector<std::string> nodes;
    for (; iterator && librdf_iterator_end(iterator.get()) == 0; librdf_iterator_next(iterator.get()))
      nodes.push_back(toNTriples(termOf(static_cast<librdf_node*>(librdf_iterator_get_object(iterator.get())))));
    return nodes;
  }

  ScratchFolder folder_;
  std::string file_ = (folder_.path() / "map.clx").string();
  std::vector<std::string> messages_;
  Handle<librdf_world> world_;
  Handle<librdf_storage> storage_;
  Handle<librdf_model> model_;
  const Term a_ = Term::iri("http://a"), b_ = Term::iri("http://b"), c_ = Term::iri("http://c");
};

TEST_F(RedlandStorage, KeepsEveryKindOfTermAsItWas) {
  const std::vector<Term> objects = {Term::iri("http://x/é"),
                                     Term::blank("n1"),
                                     Term::literal("plain"),
                                     Term::literal(""),
                                     Term::langLiteral("hallo", "de-at"),
                                     Term::literal("1", vocabulary::xsd("boolean")),
                                     Term::literal("maybe", vocabulary::xsd("boolean")),
                                     Term::literal("007", vocabulary::xsd("integer")),
                                     Term::literal("x", "http://own/type"),
                                     Term::literal(std::string(100'000, 'y') + "\"\n\\")};
  std::vector<std::string> expected;
  for (const Term& object : objects) {
    ASSERT_EQ(add(a_, b_, object), 0);
    expected.push_back(toNQuads({a_, b_, object, Term::iri("")}));
  }
  openWith("");
  EXPECT_EQ(librdf_model_size(model_.get()), static_cast<int>(objects.size()));
  EXPECT_THAT(find(a_, b_, std::nullopt), testing::UnorderedElementsAreArray(expected));
  for (const Term& object : objects) EXPECT_EQ(find(std::nullopt, std::nullopt, object).size(), 1U) << object.text;
}

TEST_F(RedlandStorage, FindsTheUnionOfGraphsOnceAndWithoutHistory) {
  add(a_, b_, c_, "http://g1");
  add(a_, b_, c_, "http://g2");
  add(c_, b_, a_, std::string(vocabulary::kGraphHistory).c_str());
  add(c_, b_, c_);
  EXPECT_EQ(find(std::nullopt, b_, std::nullopt).size(), 2U);
  EXPECT_THAT(find(c_, std::nullopt, a_), IsEmpty());
  EXPECT_EQ(drain(librdf_model_as_stream(model_.get())).size(), 4U) << "a listing loses nothing";
  const auto context = node(Term::iri("http://g2"));
  EXPECT_THAT(drain(librdf_model_context_as_stream(model_.get(), context.get())),
              ElementsAre("<http://a> <http://b> <http://c> <http://g2> .\n"));
  EXPECT_THAT(drain(librdf_model_get_contexts(model_.get())),
              UnorderedElementsAre("<http://g1>", "<http://g2>", "<" + std::string(vocabulary::kGraphHistory) + ">"));
  openWith("strict='yes'");
  EXPECT_THAT(find(std::nullopt, std::nullopt, std::nullopt), ElementsAre("<http://c> <http://b> <http://c> .\n"));
  EXPECT_EQ(librdf_model_size(model_.get()), 1);
}

TEST_F(RedlandStorage, RemovesFromOneContextOrFromAll) {
  for (const char* graph : {"http://g1", "http://g2", "http://g3"}) add(a_, b_, c_, graph);
  const auto triple = statement(a_, b_, c_);
  const auto g1 = node(Term::iri("http://g1"));
  EXPECT_EQ(librdf_model_context_remove_statement(model_.get(), g1.get(), triple.get()), 0);
  EXPECT_EQ(librdf_model_size(model_.get()), 2);
  EXPECT_NE(librdf_model_contains_statement(model_.get(), triple.get()), 0);
  const auto g2 = node(Term::iri("http://g2"));
  EXPECT_EQ(librdf_model_context_remove_statements(model_.get(), g2.get()), 0);
  EXPECT_EQ(librdf_model_size(model_.get()), 1);
  EXPECT_EQ(librdf_model_remove_statement(model_.get(), triple.get()), 0);
  EXPECT_EQ(librdf_model_contains_statement(model_.get(), triple.get()), 0);
}

TEST_F(RedlandStorage, RemovesNothingThatABuildWrites) {
  const std::string observed(vocabulary::kGraphObserved), operators(vocabulary::kGraphOperator);
  add(a_, b_, c_, observed.c_str());
  add(a_, b_, c_, operators.c_str());
  add(a_, b_, a_, operators.c_str());
  const auto both = statement(a_, b_, c_), stated = statement(a_, b_, a_);
  const auto built = node(Term::iri(observed)), own = node(Term::iri(operators));
  EXPECT_NE(librdf_model_remove_statement(model_.get(), both.get()), 0);
  ASSERT_FALSE(messages_.empty());
  EXPECT_THAT(messages_.back(), HasSubstr("graph/observed> is what a build made"));
  EXPECT_NE(librdf_model_context_remove_statement(model_.get(), built.get(), both.get()), 0);
  EXPECT_NE(librdf_model_context_remove_statements(model_.get(), built.get()), 0);
  EXPECT_EQ(librdf_model_size(model_.get()), 3);
  EXPECT_EQ(librdf_model_remove_statement(model_.get(), stated.get()), 0);
  EXPECT_EQ(librdf_model_context_remove_statement(model_.get(), own.get(), both.get()), 0);
  EXPECT_EQ(librdf_model_size(model_.get()), 1);
  add(a_, b_, a_, operators.c_str());
  EXPECT_EQ(librdf_model_context_remove_statements(model_.get(), own.get()), 0);
  EXPECT_EQ(librdf_model_size(model_.get()), 1);
}

TEST_F(RedlandStorage, RollsBackAndCommitsTransactions) {
  add(a_, b_, a_);
  ASSERT_EQ(librdf_model_transaction_start(model_.get()), 0);
  add(a_, b_, b_);
  EXPECT_EQ(find(a_, b_, std::nullopt).size(), 2U) << "a transaction sees its own changes";
  ASSERT_EQ(librdf_model_transaction_rollback(model_.get()), 0);
  EXPECT_EQ(find(a_, b_, std::nullopt).size(), 1U);
  ASSERT_EQ(librdf_model_transaction_start(model_.get()), 0);
  add(a_, b_, c_);
  ASSERT_EQ(librdf_model_transaction_commit(model_.get()), 0);
  openWith("");
  EXPECT_EQ(find(a_, b_, std::nullopt).size(), 2U);
}

TEST_F(RedlandStorage, StreamsAreSnapshotsThatChangesDoNotDisturb) {
  librdf_model_transaction_start(model_.get());
  for (int i = 0; i < 600; ++i) add(a_, b_, Term::integer(i));
  librdf_model_transaction_commit(model_.get());
  for (const bool within_transaction : {false, true}) {
    if (within_transaction) librdf_model_transaction_start(model_.get());
    const auto pattern = statement(a_, b_, std::nullopt);
    const Handle<librdf_stream> stream(librdf_model_find_statements(model_.get(), pattern.get()));
    int seen = 0;
    for (; librdf_stream_end(stream.get()) == 0; librdf_stream_next(stream.get()), ++seen)
      if (within_transaction || seen % 100 == 0)
        librdf_model_remove_statement(model_.get(), librdf_stream_get_object(stream.get()));
    EXPECT_EQ(seen, within_transaction ? 594 : 600);
    if (within_transaction) librdf_model_transaction_commit(model_.get());
  }
  EXPECT_EQ(librdf_model_size(model_.get()), 0);
}

TEST_F(RedlandStorage, AnOpenStreamOutlivesItsTransactionAndDoesNotKeepIt) {
  add(a_, b_, a_);
  for (const bool commits : {false, true}) {
    ASSERT_EQ(librdf_model_transaction_start(model_.get()), 0);
    add(a_, b_, b_);
    const auto pattern = statement(a_, b_, std::nullopt);
    Handle<librdf_stream> stream(librdf_model_find_statements(model_.get(), pattern.get()));
    ASSERT_EQ(commits ? librdf_model_transaction_commit(model_.get()) : librdf_model_transaction_rollback(model_.get()),
              0);
    EXPECT_EQ(librdf_model_transaction_start(model_.get()), 0) << "the next transaction may begin";
    EXPECT_EQ(librdf_model_transaction_rollback(model_.get()), 0);
    EXPECT_THAT(drain(stream.release()), SizeIs(2)) << "what the transaction saw";
    EXPECT_EQ(find(a_, b_, std::nullopt).size(), commits ? 2U : 1U);
  }
  EXPECT_THAT(messages_, IsEmpty());
}

TEST_F(RedlandStorage, StoresNoTermThatNoTextCanHold) {
  const auto refused = [&](const Term& object) { return add(a_, b_, object) != 0; };
  EXPECT_TRUE(refused(Term::literal("caf\xE9")));
  EXPECT_TRUE(refused(Term::langLiteral("x", "not a tag")));
  EXPECT_TRUE(refused(Term::blank("two words")));
  EXPECT_THAT(messages_, SizeIs(3));
  EXPECT_FALSE(refused(Term::literal("caf\xC3\xA9")));
  EXPECT_FALSE(refused(Term::langLiteral("x", "de-CH")));
  EXPECT_FALSE(refused(Term::blank("r1234_5-6")));
  EXPECT_EQ(librdf_model_size(model_.get()), 3);
}

TEST_F(RedlandStorage, GivesEachSourceArcAndTargetOnce) {
  add(a_, b_, c_, "http://g1");
  add(a_, b_, c_, "http://g2");
  add(a_, b_, a_);
  add(a_, c_, c_);
  const auto a = node(a_);
  const auto b = node(b_);
  const auto c = node(c_);
  EXPECT_THAT(drain(librdf_model_get_targets(model_.get(), a.get(), b.get())), ElementsAre("<http://a>", "<http://c>"));
  EXPECT_THAT(drain(librdf_model_get_sources(model_.get(), b.get(), c.get())), ElementsAre("<http://a>"));
  EXPECT_THAT(drain(librdf_model_get_arcs(model_.get(), a.get(), c.get())), ElementsAre("<http://b>", "<http://c>"));
  EXPECT_THAT(drain(librdf_model_get_arcs_out(model_.get(), a.get())), ElementsAre("<http://b>", "<http://c>"));
  EXPECT_THAT(drain(librdf_model_get_arcs_in(model_.get(), a.get())), ElementsAre("<http://b>"));
  EXPECT_NE(librdf_model_has_arc_in(model_.get(), c.get(), b.get()), 0);
  EXPECT_EQ(librdf_model_has_arc_out(model_.get(), c.get(), b.get()), 0);
}

TEST_F(RedlandStorage, TellsTheLoggerWhatWentWrong) {
  close();
  openWith("new='yes'");
  EXPECT_FALSE(model_);
  ASSERT_FALSE(messages_.empty());
  EXPECT_THAT(messages_.back(), HasSubstr("exists already"));
  openWith("write='no'");
  ASSERT_TRUE(model_);
  EXPECT_NE(add(a_, b_, c_), 0);
  EXPECT_THAT(messages_.back(), HasSubstr("reading only"));
}

TEST_F(RedlandStorage, IsListedByStockRdfproc) {
#ifdef CLUXEL_SANITIZED
  GTEST_SKIP() << "the stock program cannot load a module that wants a sanitizer's runtime";
#endif
  const fs::path modules = test::buildFolder() / "redland";
  ASSERT_TRUE(fs::exists(modules / "librdf_storage_cluxel.so")) << "the module was not built";
  if (std::system("command -v rdfproc >/dev/null") != 0) GTEST_SKIP() << "rdfproc (redland-utils) is not installed";
  add(a_, b_, Term::langLiteral("grün", "de"), "http://g");
  close();
  const std::string output = (folder_.path() / "listing").string();
  const std::string command =
      "REDLAND_MODULE_PATH='" + modules.string() + "' rdfproc -q -s cluxel '" + file_ + "' print > '" + output + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_THAT(readFile(output), HasSubstr("<http://a> <http://b> \"gr\\u00FCn\"@de"));
}

}  // namespace
}  // namespace cluxel::rdf
