// SPDX-License-Identifier: Apache-2.0
// What an update states of an object, an update deletes again; and names that the map had are told as such.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "cluxel/error.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/small_campus.hpp"
#include "mapping/stated_builds.hpp"
#include "mapping/thing_history.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

const std::string kLabelled = " <" + rdf::vocabulary::rdfs("label") + "> \"hostile\" ";

std::string inOperator(const std::string& quads) {
  return "{ GRAPH <" + std::string(rdf::vocabulary::kGraphOperator) + "> { " + quads + " } }";
}

class DeletedQuads : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 5, .stops = 2, .size_m = 45, .points_per_stop = 2500});
    built = new ScratchFolder;
    buildMap(scansOf({campus->files()}), shippedInputs(), built->path() / "map.clx", {}, silence());
  }
  static void TearDownTestSuite() {
    delete campus;
    delete built;
  }
  void SetUp() override {
    fs::copy_file(built->path() / "map.clx", map());
    const MapReader reader(map());
    for (const rules::SemanticObject& object : reader.objects())
      if (!object.is_class_wide) id = object.id;
    object = "<" + rdf::iriOfObject(id) + ">";
  }
  fs::path map() const { return folder.path() / "map.clx"; }

  MapUpdateReport update(const std::string& text, const MapUpdateParams& params = {}) {
    notes.all.clear();
    return updateMap(map(), text, {}, notes, params);
  }
  std::vector<KnownStatement> statements() const { return knownStatements(MapReader(map()).quads()); }
  std::string nameOfThing() const {
    const MapReader reader(map());
    return "<" + thingOf(storedThings(reader.quads()), id).iri + ">";
  }

  ScratchFolder folder;
  ContentHash id;      ///< of an object
  std::string object;  ///< its IRI
  StatementNotes notes;
  inline static SmallCampus* campus = nullptr;
  inline static ScratchFolder* built = nullptr;
};

TEST_F(DeletedQuads, WithdrawTheStatementsThatTheyHaveBecome) {
  const std::string before = canonicalText(map());
  for (const std::string& name : {object, nameOfThing()}) {
    update("INSERT DATA { " + object + kLabelled + "}");
    ASSERT_EQ(statements().size(), 1U);
    const std::string statement = statements().front().statement.id().hex();
    EXPECT_EQ(update("DELETE DATA " + inOperator(name + kLabelled), {.dry_run = true}).deleted, 1U);
    EXPECT_EQ(statements().size(), 1U) << "only tried";
    EXPECT_EQ(update("DELETE DATA " + inOperator(name + kLabelled)).deleted, 1U);
    EXPECT_THAT(notes.all, AllOf(HasSubstr(statement), HasSubstr("withdrawn")));
    EXPECT_TRUE(statements().empty());
    EXPECT_TRUE(canonicalText(map()) == before);
  }
  EXPECT_EQ(update("DELETE DATA " + inOperator(object + kLabelled)).deleted, 0U) << "nothing is stated";
}

TEST_F(DeletedQuads, OfClassesAndOfPatternsDoSo) {
  const std::string sign = " a <" + rdf::vocabulary::clx("StreetSign") + "> ";
  update("INSERT DATA { " + object + sign + "; " + kLabelled + "}");
  ASSERT_EQ(statements().size(), 2U);
  const std::string label = "?o <" + rdf::vocabulary::rdfs("label") + "> ";
  EXPECT_EQ(update("DELETE " + inOperator(label + "?l") + " INSERT " + inOperator(label + "\"kind\"") + " WHERE { " +
                   label + "\"hostile\" . " + label + "?l . ?o a ?class . FILTER(?l = \"hostile\") }")
                .deleted,
            1U);
  const std::vector<KnownStatement> both = statements();
  ASSERT_EQ(both.size(), 2U);
  EXPECT_TRUE(std::any_of(both.begin(), both.end(),
                          [](const KnownStatement& known) { return known.statement.value.text == "kind"; }));
  for (const KnownStatement& known : both)
    if (known.statement.kind == StatementKind::Is) update("DELETE DATA " + inOperator("<" + known.object + ">" + sign));
  ASSERT_EQ(statements().size(), 1U);
  EXPECT_EQ(statements().front().statement.value.text, "kind");
}

TEST_F(DeletedQuads, LeaveOtherStatementsAndWhatIsStatedAgain) {
  update("INSERT DATA { " + object + kLabelled + "}");
  const std::string before = canonicalText(map());
  const std::string other = object + " <" + rdf::vocabulary::rdfs("label") + "> \"other\" ";
  EXPECT_EQ(update("DELETE DATA " + inOperator(other)).deleted, 0U);
  update("DELETE DATA " + inOperator(object + kLabelled) + " ; INSERT DATA { " + object + kLabelled + "}");
  EXPECT_TRUE(canonicalText(map()) == before);
  update("INSERT DATA { " + object + kLabelled + "} ; DELETE DATA " + inOperator(object + kLabelled));
  EXPECT_TRUE(statements().empty()) << "the deletion is last";
}

TEST_F(DeletedQuads, WithdrawOnlyWhatIsStatedOfTheirObject) {
  const MapReader reader(map());
  std::vector<std::string> objects;
  for (const rules::SemanticObject& each : reader.objects())
    if (!each.is_class_wide && objects.size() < 3) objects.push_back("<" + rdf::iriOfObject(each.id) + ">");
  ASSERT_EQ(objects.size(), 3U);
  std::string all;
  for (const std::string& each : objects) all += each + kLabelled + ". ";
  update("INSERT DATA { " + all + "}");
  ASSERT_EQ(statements().size(), 3U);
  EXPECT_EQ(update("DELETE DATA " + inOperator(objects[0] + kLabelled + ". " + objects[2] + kLabelled)).deleted, 2U);
  ASSERT_EQ(statements().size(), 1U);
  EXPECT_EQ("<" + statements().front().object + ">", objects[1]);
}

TEST_F(DeletedQuads, WithdrawStatementsBesideAMalformedOne) {
  update("INSERT DATA { " + object + kLabelled + "}");
  const std::string statement = statements().front().statement.id().hex();
  const std::string malformed =
      "<" + rdf::iriOfStatement(ContentHash()) + "> a <" + rdf::vocabulary::clx("OperatorStatement") + "> ";
  rdf::WriteTransaction transaction = rdf::Environment::open(map(), rdf::OpenMode::ReadWrite)->write();
  sparql::runUpdate(transaction, "INSERT DATA " + inOperator(malformed), {});
  transaction.commit();
  EXPECT_EQ(update("DELETE DATA " + inOperator(malformed + " . " + object + kLabelled)).deleted, 2U);
  EXPECT_THAT(notes.all, AllOf(HasSubstr(statement), HasSubstr("withdrawn")));
  EXPECT_TRUE(statements().empty());
}

TEST_F(DeletedQuads, WithoutAGraphAreRefusedWithTheWayThatWorks) {
  update("INSERT DATA { " + object + kLabelled + "}");
  const std::string statement = statements().front().statement.id().hex();
  try {
    update("DELETE DATA { " + object + kLabelled + "}");
    FAIL() << "it was deleted";
  } catch (const InputError& fault) {
    EXPECT_THAT(format(fault.diagnostics().front()),
                AllOf(HasSubstr("the operator statement " + statement + " says this: withdraw it"),
                      HasSubstr(std::string(rdf::vocabulary::kGraphOperator))));
  }
}

TEST_F(DeletedQuads, OfObjectsThatTheMapHadTellTheirEnd) {
  retractScans(map(), {scansOf({campus->files()}).load(0).id}, {}, silence());
  std::string gone;
  forEachHistoryLink(MapReader(map()).quads(), "wasInvalidatedBy",
                     [&](const Term& ended, const Term&) { gone = ended.text; });
  ASSERT_NE(gone, "") << "each object goes on";
  update("INSERT DATA { <" + gone + ">" + kLabelled + "}");
  const std::string end = "object/" + gone.substr(gone.rfind('/') + 1) + " ended at ";
  EXPECT_THAT(notes.all,
              AllOf(HasSubstr("<" + gone + "> is an object that this map had. " + end),
                    HasSubstr("by `retract`, and nothing that there is continues it: what is stated of it")));
  try {
    update("INSERT DATA { <" + gone + "> a <" + rdf::vocabulary::clx("Person") + "> }");
    FAIL() << "it is stated";
  } catch (const Error& fault) {
    EXPECT_THAT(fault.what(), AllOf(HasSubstr("no object that the map has now: " + end),
                                    HasSubstr("cannot be stated before the map has the object again")));
  }
}

}  // namespace
}  // namespace cluxel::mapping
