// SPDX-License-Identifier: Apache-2.0
// What was withdrawn stays withdrawn, whichever copies of a map are merged; quads are held to the same rules.
#include "mapping/statements/statement_history.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <utility>

#include "cluxel/error.hpp"
#include "mapping/build/operator_statements.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/map_merge.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/small_campus.hpp"
#include "mapping/stated_builds.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAre;

class StatementHistory : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 6, .stops = 2, .size_m = 45, .points_per_stop = 1200});
    inputs = new MapInputs(shippedInputs());
    built = new ScratchFolder;
    buildMap(scansOf(campus->files()), *inputs, built->path() / "map.clx", {}, silence());
  }
  static void TearDownTestSuite() {
    delete campus;
    delete inputs;
    delete built;
  }
  void SetUp() override { fs::copy_file(built->path() / "map.clx", map()); }

  fs::path map(const std::string& name = "map.clx") const { return folder.path() / name; }
  fs::path copied(const std::string& name) const {
    fs::copy_file(map(), map(name), fs::copy_options::overwrite_existing);
    return map(name);
  }
  Statement about(std::size_t number, StatementKind kind, const std::string& local) const {
    const MapReader reader(map());
    std::vector<const rules::SemanticObject*> things;
    for (const rules::SemanticObject& object : reader.objects())
      if (object.class_iri != vocabulary::clx("Ground")) things.push_back(&object);
    return {kind, "", Term::iri(vocabulary::clx(local)), anchorOf(reader.stagesWithPoints(), *things.at(number)), {}};
  }
  static void state(const fs::path& file, const std::vector<Statement>& made,
                    const std::vector<ContentHash>& withdrawn = {}, const std::string& author = "anna") {
    changeStatements(file, {made, withdrawn, author}, {}, silence());
  }
  static std::vector<ContentHash> statementsOf(const fs::path& file) {
    std::vector<ContentHash> ids;
    for (const Statement& statement : storedStatements(MapReader(file).quads())) ids.push_back(statement.id());
    return ids;
  }
  /// Merges both ways, and expects the same map of both.
  fs::path merged(const fs::path& a, const fs::path& b, StatementNotes& notes) const {
    mergeMaps({{b}, {a}}, map("other"), {.change = {}, .use = std::nullopt, .force = true}, silence());
    mergeMaps({{a}, {b}}, map("merged"), {.change = {}, .use = std::nullopt, .force = true}, notes);
    EXPECT_TRUE(canonicalText(map("merged")) == canonicalText(map("other"))) << "the order of the maps counts";
    return map("merged");
  }
  static std::string deletionOf(const ContentHash& id) {
    return "DELETE WHERE { GRAPH <" + std::string(vocabulary::kGraphOperator) + "> { <" + rdf::iriOfStatement(id) +
           "> ?p ?o } }";
  }

  ScratchFolder folder;
  inline static SmallCampus* campus = nullptr;
  inline static MapInputs* inputs = nullptr;
  inline static ScratchFolder* built = nullptr;
};

TEST_F(StatementHistory, AnOlderCopyDoesNotBringBackWhatWasWithdrawn) {
  const Statement sign = about(0, StatementKind::Is, "StreetSign"), lamp = about(1, StatementKind::Is, "StreetLamp");
  state(map(), {sign, lamp});
  const fs::path older = copied("older");
  state(map(), {}, {sign.id()});
  StatementNotes notes;
  const fs::path both = merged(map(), older, notes);
  EXPECT_THAT(statementsOf(both), UnorderedElementsAre(lamp.id()));
  EXPECT_THAT(notes.all, HasSubstr("1 operator statements are left out"));
  EXPECT_THAT(notes.all, HasSubstr(sign.id().hex()));
  EXPECT_TRUE(canonicalText(both) == canonicalText(map()));
  StatementNotes again;
  EXPECT_THAT(statementsOf(merged(copied("third"), older, again)), UnorderedElementsAre(lamp.id()));
}

TEST_F(StatementHistory, WhatWasStatedAgainAfterItsWithdrawalStays) {
  const Statement sign = about(0, StatementKind::Is, "StreetSign");
  state(map(), {sign});
  const fs::path older = copied("older");
  state(map(), {}, {sign.id()});
  state(map(), {sign});
  StatementNotes notes;
  EXPECT_THAT(statementsOf(merged(map(), older, notes)), UnorderedElementsAre(sign.id()));
  const fs::path withdrawn = copied("withdrawn");
  state(withdrawn, {}, {sign.id()});
  state(older, {}, {sign.id()});
  state(older, {sign});
  EXPECT_THAT(statementsOf(merged(withdrawn, older, notes)), UnorderedElementsAre(sign.id()));
  EXPECT_EQ(notes.all.find("left out"), std::string::npos);
}

/// Nothing can compute again what an operator stated in the map that a merge replaces.
TEST_F(StatementHistory, AMergeDropsWhatOnlyTheReplacedMapKnowsWhenToldTo) {
  const Statement sign = about(0, StatementKind::Is, "StreetSign"), lamp = about(1, StatementKind::Is, "StreetLamp");
  state(map(), {sign});
  const fs::path older = copied("older"), target = copied("target");
  const auto merge = [&](bool drop_statements) {
    StatementNotes notes;
    mergeMaps({{map()}, {older}}, target,
              {.change = {}, .use = std::nullopt, .force = true, .drop_statements = drop_statements}, notes);
    return notes.all;
  };
  const auto expectRefused = [&](const std::string& why) {
    const std::string before = canonicalText(target);
    try {
      merge(false);
      ADD_FAILURE() << why;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument);
      EXPECT_EQ(error.remedy(), Remedy::DropStatements) << error.what();
    }
    EXPECT_TRUE(canonicalText(target) == before) << why;
    EXPECT_THAT(merge(true), HasSubstr("are dropped"));
    EXPECT_TRUE(canonicalText(target) == canonicalText(map())) << why;
  };
  EXPECT_THAT(merge(false), Not(HasSubstr("are dropped"))) << "all that it states is in the maps";
  state(target, {lamp});
  expectRefused("its own statement");
  state(target, {}, {sign.id()});
  expectRefused("its own withdrawal");
  updateMap(target, "INSERT DATA { <https://e.org/a> <https://e.org/b> [ <https://e.org/c> 1 ] }", {}, silence());
  expectRefused("its own facts");
  state(map(), {}, {sign.id()});
  merge(false);
  EXPECT_THAT(statementsOf(target), IsEmpty()) << "one of the maps has withdrawn it";
}

TEST_F(StatementHistory, AStatementThatComesWhileAMergeRunsIsNotDropped) {
  const fs::path older = copied("older"), target = copied("target");
  class StatingSink : public ProgressSink {
   public:
    explicit StatingSink(std::function<void()> act) : act_(std::move(act)) {}
    void note(std::string_view) override { actOnce(); }
    void progress(std::string_view, std::size_t, std::size_t) override { actOnce(); }
    bool has_acted = false;

   private:
    void actOnce() {
      if (!std::exchange(has_acted, true)) act_();
    }
    std::function<void()> act_;
  };
  const std::string fact = "<https://e.org/a> <https://e.org/b> 1";
  StatingSink sink([&] { updateMap(target, "INSERT DATA { " + fact + " }", {}, silence()); });
  EXPECT_THROW(mergeMaps({{map()}, {older}}, target, {.change = {}, .use = std::nullopt, .force = true}, sink), Error);
  EXPECT_TRUE(sink.has_acted);
  EXPECT_THAT(canonicalText(target), HasSubstr("<https://e.org/b>"));
  EXPECT_FALSE(fs::exists(target.string() + ".merging"));
}

TEST_F(StatementHistory, OfMapsWhoseRulesDecideAlikeIsMergedInAnyOrder) {
  MapInputs other = *inputs;
  std::string& text = other.rules.front().text;
  const std::string number = "machine_made: [ height >= 3 m";
  text.replace(text.find(number), number.size(), "machine_made: [ height >= 3.0001 m");
  const Statement bush = about(0, StatementKind::Is, "Bush");
  const fs::path plain = copied("plain"), changed = copied("changed");
  applyInputs(
      changed, [&](const MapInputs&) { return other; }, {}, silence());
  const fs::path unstated = map("unstated");
  fs::copy_file(changed, unstated);
  const auto expectSame = [&](const fs::path& last, const std::function<void(const fs::path&)>& change) {
    buildMap(scansOf(campus->files()), other, map("scratch"), {}, silence());
    change(map("scratch"));
    for (const bool is_first : {true, false}) {
      const std::vector<MapToMerge> maps =
          is_first ? std::vector<MapToMerge>{{last}, {plain}} : std::vector<MapToMerge>{{plain}, {last}};
      mergeMaps(maps, map("all"), {.change = {}, .use = is_first ? 0 : 1, .force = true, .drop_statements = true},
                silence());
      EXPECT_TRUE(canonicalText(map("all")) == canonicalText(map("scratch"))) << last << is_first;
      EXPECT_EQ(knownStatements(MapReader(map("all")).quads()).size(), statementsOf(last).size());
      for (const KnownStatement& known : knownStatements(MapReader(map("all")).quads()))
        EXPECT_EQ(known.effect, nameOf(StatementEffect::Applied));
    }
    fs::remove(map("scratch"));
  };
  state(changed, {bush});
  expectSame(changed, [&](const fs::path& file) { state(file, {bush}); });
  const std::string tree = "INSERT DATA { <http://e/a> a <" + vocabulary::clx("Tree") + "> }";
  updateMap(unstated, tree, {}, silence());
  expectSame(unstated, [&](const fs::path& file) { updateMap(file, tree, {}, silence()); });
  state(plain, {bush});
  fs::copy_file(plain, unstated, fs::copy_options::overwrite_existing);
  applyInputs(
      unstated, [&](const MapInputs&) { return other; }, {}, silence());
  state(unstated, {}, {bush.id()});
  expectSame(unstated, [](const fs::path&) {});
}

TEST_F(StatementHistory, AnUpdateWithdrawsToo) {
  const Statement sign = about(0, StatementKind::Is, "StreetSign");
  state(map(), {sign});
  const fs::path older = copied("older");
  updateMap(map(), deletionOf(sign.id()), {}, silence());
  StatementNotes notes;
  EXPECT_THAT(statementsOf(merged(map(), older, notes)), UnorderedElementsAre());
}

TEST_F(StatementHistory, NamesAllAuthorsOfAStatementOnce) {
  const Statement sign = about(0, StatementKind::Is, "StreetSign");
  const fs::path other = copied("other.clx");
  state(map(), {sign}, {}, "bert");
  state(other, {sign}, {}, "anna");
  StatementNotes notes;
  const auto known = knownStatements(MapReader(merged(map(), other, notes)).quads());
  ASSERT_EQ(known.size(), 1U);
  EXPECT_EQ(known[0].author, "anna, bert");
}

TEST_F(StatementHistory, OfQuadsIsCheckedAsTheCommandChecksStatements) {
  const Statement cluxel = about(0, StatementKind::Is, "Cluxel");
  std::string quads;
  for (const Quad& quad : quadsOf(cluxel))
    quads += toNTriples(quad.subject) + " " + toNTriples(quad.predicate) + " " + toNTriples(quad.object) + " . ";
  const std::string before = canonicalText(map());
  try {
    updateMap(map(), "INSERT DATA { " + quads + " }", {}, silence());
    ADD_FAILURE() << "a statement was taken that `state` refuses";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("is no class of objects"));
  }
  EXPECT_TRUE(canonicalText(map()) == before);
}

TEST_F(StatementHistory, AWithdrawalThatIsNamedTwiceIsOne) {
  const Statement sign = about(0, StatementKind::Is, "StreetSign");
  state(map(), {sign});
  state(map(), {}, {sign.id(), sign.id()});
  EXPECT_TRUE(statementsOf(map()).empty());
}

TEST_F(StatementHistory, StaysWhenTheMapIsBuiltAnew) {
  const Statement kept = about(0, StatementKind::Is, "StreetLamp"), gone = about(1, StatementKind::Is, "Bush");
  state(map(), {kept, gone});
  state(map(), {}, {gone.id()}, "ben");
  const auto before = recordOf(MapReader(map()).quads(), kept.id());
  buildMap(scansOf(campus->files()), *inputs, map(), {.force = true}, silence());
  const MapReader reader(map());
  EXPECT_EQ(recordOf(reader.quads(), kept.id()).author, "anna");
  EXPECT_EQ(recordOf(reader.quads(), kept.id()).stated_at, before.stated_at);
  EXPECT_EQ(withdrawnStatements(reader.quads()), std::vector{gone.id()});
}

}  // namespace
}  // namespace cluxel::mapping
