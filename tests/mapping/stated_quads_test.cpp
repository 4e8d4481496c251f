// SPDX-License-Identifier: Apache-2.0
// What quads of an update mean follows from the map on which it is made. Names in them that change are noted, and what
// the map computes is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/change/rdf_loading.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/small_campus.hpp"
#include "mapping/stated_builds.hpp"
#include "mapping/statements/stated_values.hpp"
#include "mapping/thing_history.hpp"
#include "rdf/file/map_replacement.hpp"
#include "rdf/map_iris.hpp"
#include "rules/objects/finished_objects.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

const std::string kInOperator = "GRAPH <" + std::string(rdf::vocabulary::kGraphOperator) + "> ";
const std::string kInHistory = "GRAPH <" + std::string(rdf::vocabulary::kGraphHistory) + "> ";
const std::string kLabel = "<" + rdf::vocabulary::rdfs("label") + ">";
const std::string kUnder = "<http://example.org/under>";

class StatedQuads : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 5, .stops = 3, .size_m = 45, .points_per_stop = 2500});
    inputs = new MapInputs(shippedInputs());
    built = new ScratchFolder;
    buildMap(scans(0, 2), *inputs, built->path() / "two.clx", {}, silence());
    fs::copy_file(built->path() / "two.clx", built->path() / "three.clx");
    extendMap(built->path() / "three.clx", scans(2, 3), {}, silence());
  }
  static void TearDownTestSuite() {
    delete campus;
    delete inputs;
    delete built;
  }
  void SetUp() override { fs::copy_file(built->path() / "two.clx", map()); }

  static ScanSet scans(std::size_t first, std::size_t end) {
    return scansOf({campus->files().begin() + static_cast<std::ptrdiff_t>(first),
                    campus->files().begin() + static_cast<std::ptrdiff_t>(end)});
  }
  fs::path map() const { return folder.path() / "map.clx"; }

  static std::set<std::string> objectsOf(const fs::path& file) {
    const MapReader reader(file);
    std::set<std::string> iris;
    for (const rules::SemanticObject& object : reader.objects())
      if (!object.is_class_wide) iris.insert(rdf::iriOfObject(object.id));
    return iris;
  }
  /// An object that only one of two maps has.
  static std::string objectOnlyIn(const fs::path& file, const fs::path& other) {
    const std::set<std::string> others = objectsOf(other);
    for (const std::string& iri : objectsOf(file))
      if (!others.contains(iri)) return iri;
    throw std::runtime_error("both maps have the same objects");
  }
  /// The map of the same scans, built from scratch with the statements that the map has.
  std::string fromScratch(std::size_t scan_count) const {
    return builtWithStatementsOf(map(), scans(0, scan_count), *inputs);
  }
  std::string update(const std::string& text) const {
    StatementNotes notes;
    updateMap(map(), text, {}, notes);
    return notes.all;
  }
  std::string faultOf(const std::string& text) const {
    try {
      update(text);
      return "";
    } catch (const Error& fault) {
      return fault.what();
    }
  }
  bool holds(const std::string& pattern) const {
    const MapReader reader(map());
    return sparql::PreparedQuery(reader.quads(), "ASK { " + pattern + " }").ask();
  }
  void updateSomethingElse() const {
    update("INSERT DATA { <http://example.org/a> <http://example.org/b> 1 }");
    update("DELETE DATA { " + kInOperator + "{ <http://example.org/a> <http://example.org/b> 1 } }");
  }

  ScratchFolder folder;
  inline static SmallCampus* campus = nullptr;
  inline static MapInputs* inputs = nullptr;
  inline static ScratchFolder* built = nullptr;
};

TEST_F(StatedQuads, OfAnObjectThatComesLaterMeanTheSameBeforeAndAfterIt) {
  const std::string object = "<" + objectOnlyIn(built->path() / "three.clx", map()) + ">";
  EXPECT_THAT(update("INSERT DATA { " + object + " " + kLabel + " \"later\" }"),
              HasSubstr("changes no object, now or later"));
  extendMap(map(), scans(2, 3), {}, silence());
  const std::string extended = canonicalText(map());
  EXPECT_TRUE(extended == fromScratch(3));
  updateSomethingElse();
  EXPECT_TRUE(canonicalText(map()) == extended) << "an update changed what another had stated";
  EXPECT_TRUE(knownStatements(MapReader(map()).quads()).empty());
  update("DELETE DATA { " + kInOperator + "{ " + object + " " + kLabel + " \"later\" } }");
  update("INSERT DATA { " + object + " " + kLabel + " \"later\" }");
  EXPECT_EQ(knownStatements(MapReader(map()).quads()).size(), 1U) << "stated again of the object that is there now";
  EXPECT_TRUE(canonicalText(map()) == fromScratch(3));
}

TEST_F(StatedQuads, OfAnObjectThatComesLaterCannotContradictIt) {
  const std::string before = canonicalText(map());
  const std::string object = objectOnlyIn(built->path() / "three.clx", map());
  EXPECT_THAT(faultOf("INSERT DATA { <" + object + "> <" + rdf::vocabulary::clx("height") + "> 5 }"),
              testing::AllOf(HasSubstr(object), HasSubstr("is computed by the map")));
  EXPECT_THAT(faultOf("INSERT DATA { <" + object + "> a <" + rdf::vocabulary::clx("Person") + "> }"),
              testing::AllOf(HasSubstr(object), HasSubstr("cannot be stated before the map has the object")));
  EXPECT_TRUE(canonicalText(map()) == before);
}

TEST_F(StatedQuads, ThatStandUnderTheNameOfAnObjectAreNotedWhenTheyAreStatedAgain) {
  const std::string object = "<" + objectOnlyIn(built->path() / "three.clx", map()) + ">";
  const std::string quad = object + " " + kLabel + " \"later\" ";
  const std::string remedy =
      "1 quad stands already under the name of an object that the map knows now, such as " + object;
  EXPECT_THAT(update("INSERT DATA { " + quad + "}"), Not(HasSubstr("stands already")));
  EXPECT_THAT(update("INSERT DATA { " + quad + "}"), Not(HasSubstr("stands already"))) << "there is no object yet";
  extendMap(map(), scans(2, 3), {}, silence());
  EXPECT_THAT(update("INSERT DATA { " + quad + "}"), HasSubstr(remedy));
  EXPECT_THAT(update("DELETE DATA { " + kInOperator + "{ " + quad + "} } ; INSERT DATA { " + quad + "}"),
              HasSubstr(remedy));
  const fs::path file = folder.path() / "later.nt";
  writeFile(file, quad + ".\n");
  StatementNotes notes;
  EXPECT_EQ(loadRdfFiles(map(), {file}, {}, notes).added, 0U);
  EXPECT_THAT(notes.all, HasSubstr(remedy));
  EXPECT_THAT(update("DELETE DATA { " + kInOperator + "{ " + quad + "} }"), Not(HasSubstr("stands already")));
  EXPECT_THAT(update("INSERT DATA { " + quad + "}"),
              HasSubstr("1 statement about an object is anchored to its points"));
  EXPECT_EQ(knownStatements(MapReader(map()).quads()).size(), 1U);
}

/// Whoever has a file of a thousand quads must find the one that is refused.
TEST_F(StatedQuads, ThatAreRefusedAreFaultsOfTheirSourceWhichIsNamedWithTheLineAndTheSubject) {
  const std::string before = canonicalText(map());
  const std::string object = "<" + *objectsOf(map()).begin() + ">";
  const std::string clx = "<" + rdf::vocabulary::clx("");
  const std::map<std::string, std::string> refused{
      {clx + "height> 3", "is computed by the map"},
      {"<http://example.org/n> []", "is a blank node"},
      {"a " + clx + "Tre>", "did you mean 'Tree'?"},
      {"a " + clx + "Ground>", "is one object over all of the map"},
      {"a \"Tree\"", "the map's ontology knows no class \"Tree\""},
      {"a <http://example.org/K>", "the map's ontology knows no class <http://example.org/K>"}};
  const fs::path fine = folder.path() / "fine.ttl", faulty = folder.path() / "faulty.ttl";
  writeFile(fine, object + " " + kLabel + " \"fine\" .\n");
  for (const auto& [stated, message] : refused) {
    writeFile(faulty, "# a comment\n" + object + " " + kUnder + " 1 .\n" + object + " " + stated + " .\n");
    StatementNotes notes;
    try {
      loadRdfFiles(map(), {fine, faulty}, {}, notes);
      ADD_FAILURE() << stated << " was loaded";
    } catch (const InputError& fault) {
      EXPECT_EQ(fault.kind(), ErrorKind::FaultyInput);
      EXPECT_EQ(toString(fault.diagnostics().front().location), faulty.string() + ":3");
      EXPECT_THAT(fault.what(), testing::AllOf(HasSubstr(object), HasSubstr(message)));
    }
    try {
      updateMap(map(), "INSERT DATA { " + object + " " + kUnder + " 1 ; " + stated + " }",
                {.query = {.source_name = "mine.ru"}}, notes);
      ADD_FAILURE() << stated << " was inserted";
    } catch (const InputError& fault) {
      EXPECT_EQ(fault.diagnostics().front().location.file, "mine.ru");
      EXPECT_THAT(fault.what(), testing::AllOf(HasSubstr(object), HasSubstr(message)));
    }
    EXPECT_EQ(notes.all, "") << "of a change that was not made";
  }
  EXPECT_TRUE(canonicalText(map()) == before);
}

TEST_F(StatedQuads, OfOtherGraphsAreFaultsOfTheirFile) {
  const fs::path file = folder.path() / "other.nq";
  writeFile(file, "<http://e/a> <http://e/p> \"1\" .\n<http://e/a> <http://e/p> <http://e/b> <http://e/graph> .\n");
  try {
    loadRdfFiles(map(), {file}, {}, silence());
    FAIL() << "it was loaded";
  } catch (const InputError& fault) {
    EXPECT_EQ(toString(fault.diagnostics().front().location), file.string() + ":2");
    EXPECT_THAT(fault.what(), HasSubstr("<http://e/a> stands in graph <http://e/graph>"));
  }
}

TEST_F(StatedQuads, AreNotWhatTheHistoryTells) {
  EXPECT_THAT(faultOf("ADD <" + std::string(rdf::vocabulary::kGraphHistory) + "> TO <" +
                      std::string(rdf::vocabulary::kGraphOperator) + ">"),
              HasSubstr("of an object is computed by the map"));
  EXPECT_TRUE(knownStatements(MapReader(map()).quads()).empty());
}

/// As a program of an earlier version left them.
TEST_F(StatedQuads, ThatStandInTheMapDoNotBlockOtherUpdates) {
  {
    rdf::WriteTransaction transaction = rdf::writeMap(map());
    addOperatorStatements(transaction, {{Term::iri(*objectsOf(map()).begin()),
                                         Term::iri(rdf::vocabulary::clx("height")),
                                         Term::literal("5", rdf::vocabulary::xsd("integer")),
                                         {}}});
    transaction.commit();
  }
  const std::string before = canonicalText(map());
  updateSomethingElse();
  EXPECT_TRUE(canonicalText(map()) == before);
}

TEST_F(StatedQuads, AsValuesDoNotFollowTheirObjectsButThingsDo) {
  const std::string changing = objectOnlyIn(map(), built->path() / "three.clx");
  const std::string subject = *objectsOf(map()).begin();
  const std::string notes = update("INSERT DATA { <" + subject + "> " + kUnder + " <" + changing + "> }");
  EXPECT_THAT(notes, HasSubstr("<" + changing + "> is the name of an object"));
  const std::size_t at = notes.find("<" + rdf::mapIri("thing", ""));
  ASSERT_NE(at, std::string::npos) << notes;
  const std::string thing = notes.substr(at, notes.find('>', at) + 1 - at);
  EXPECT_THAT(update("INSERT DATA { <" + subject + "> " + kUnder + " " + thing + " }"), Not(HasSubstr("the value")));
  extendMap(map(), scans(2, 3), {}, silence());
  EXPECT_TRUE(holds("?s " + kUnder + " ?thing . ?object a ?class . " + kInHistory +
                    "{ ?object <http://www.w3.org/ns/prov#specializationOf> ?thing }"));
  EXPECT_FALSE(holds("?s " + kUnder + " ?object . " + "?object <" + rdf::vocabulary::clx("confidence") + "> ?c"));
}

TEST_F(StatedQuads, OfPartsAreNoted) {
  const std::string part = [&] {
    const MapReader reader(map());
    rdf::QuadCursor cursor = reader.quads().scan(
        {.s = {}, .p = reader.quads().idOf(Term::iri(rdf::vocabulary::clx("hasPart"))), .o = {}, .g = {}});
    rdf::QuadIds quad;
    if (!cursor.next(quad)) throw std::runtime_error("no object has a part");
    return toNTriples(reader.quads().termOf(quad.o));
  }();
  EXPECT_THAT(update("INSERT DATA { " + part + " " + kLabel + " \"old trunk\" }"),
              HasSubstr(part + " is no object: what is stated of parts"));
}

/// The properties that a graph gives to resources of a kind.
std::set<std::string> propertiesOf(const rdf::QuadReader& quads, const std::string& kind,
                                   std::string_view graph = rdf::vocabulary::kGraphObserved) {
  const std::string begin = rdf::mapIri(kind, "");
  const auto in_graph = quads.idOf(Term::iri(graph));
  std::set<std::string> properties;
  rdf::QuadCursor cursor = quads.scan({.s = {}, .p = {}, .o = {}, .g = in_graph});
  for (rdf::QuadIds quad; cursor.next(quad);) {
    const std::string subject = quads.termOf(quad.s).text;
    if (subject.starts_with(begin) && subject.find('/', begin.size()) == std::string::npos)
      properties.insert(quads.termOf(quad.p).text);
  }
  return properties;
}

/// The datatype properties of `domain` in the ontology.
std::set<std::string> attributesOf(const rdf::QuadReader& quads, const std::string& domain) {
  const auto of = quads.idOf(Term::iri(domain));
  const auto has_domain = quads.idOf(Term::iri(rdf::vocabulary::rdfs("domain")));
  const auto type = quads.idOf(Term::iri(rdf::vocabulary::rdf("type")));
  const auto attribute = quads.idOf(Term::iri("http://www.w3.org/2002/07/owl#DatatypeProperty"));
  if (!of || !has_domain || !type || !attribute) throw std::runtime_error("the ontology lacks attributes");
  std::set<std::string> properties;
  rdf::QuadCursor cursor = quads.scan({.s = {}, .p = *has_domain, .o = *of, .g = {}});
  for (rdf::QuadIds quad; cursor.next(quad);) {
    rdf::QuadCursor typed = quads.scan({.s = quad.s, .p = *type, .o = *attribute, .g = {}});
    if (rdf::QuadIds ignored; typed.next(ignored)) properties.insert(quads.termOf(quad.s).text);
  }
  return properties;
}

TEST_F(StatedQuads, StateNothingThatTheMapTellsOfObjectsAndStatements) {
  const std::string object = *objectsOf(map()).begin();
  update("INSERT DATA { <" + object + "> a <" + rdf::vocabulary::clx("StreetSign") + "> }");
  const MapReader reader(map());
  std::set<std::string> told = propertiesOf(reader.quads(), "object");
  EXPECT_GE(told.size(), 20U);
  told.merge(attributesOf(reader.quads(), rdf::vocabulary::clx("Object")));
  EXPECT_TRUE(told.contains(rdf::vocabulary::clx("porosity"))) << "which only barriers have";
  const std::set<std::string> of_statements = propertiesOf(reader.quads(), "statement");
  EXPECT_TRUE(of_statements.contains(rdf::vocabulary::clx("contradictsRules")));
  told.insert(of_statements.begin(), of_statements.end());
  for (const std::string& property : told) EXPECT_THROW(requireStatable(property), Error) << property;
}

TEST_F(StatedQuads, StateNothingThatTheHistoryTellsOfObjectsAndThings) {
  const MapReader changed(built->path() / "three.clx");
  std::set<std::string> told = propertiesOf(changed.quads(), "object", rdf::vocabulary::kGraphHistory);
  told.merge(propertiesOf(changed.quads(), "thing", rdf::vocabulary::kGraphHistory));
  for (const std::string property : {"specializationOf", "wasDerivedFrom", "wasGeneratedBy", "generatedAtTime"})
    EXPECT_TRUE(told.contains(provenance(property))) << property;
  told.insert({provenance("wasInvalidatedBy"), provenance("invalidatedAtTime"), isReplacedBy()});
  for (const std::string& property : told) EXPECT_THROW(requireStatable(property), Error) << property;
  const std::string of_things = " <" + provenance("invalidatedAtTime") + "> \"2020-01-01T00:00:00Z\" ";
  const std::string thing = [&] {
    const MapReader reader(map());
    return storedThings(reader.quads()).begin()->second.front().iri;
  }();
  EXPECT_THAT(faultOf("INSERT DATA { <" + thing + ">" + of_things + "}"), HasSubstr("is computed by the map"));
}

/// The user would look for a fault in a file that has none.
TEST_F(StatedQuads, ThatCannotBeCheckedInADamagedMapAreNoFaultsOfTheirSource) {
  const std::string object = *objectsOf(map()).begin(), sign = rdf::vocabulary::clx("StreetSign");
  {
    rdf::WriteTransaction transaction = rdf::writeMap(map());
    transaction.putBlock(tables::kObjects, tables::keyOf(rules::idOfClassWide(sign)), "damaged");
    transaction.commit();
  }
  StatementNotes notes;
  try {
    updateMap(map(), "INSERT DATA { <" + object + "> a <" + sign + "> }", {.query = {.source_name = "mine.ru"}}, notes);
    FAIL() << "it was inserted";
  } catch (const Error& fault) {
    EXPECT_EQ(fault.kind(), ErrorKind::StoreUnavailable) << fault.what();
    EXPECT_THAT(fault.what(), Not(HasSubstr("mine.ru")));
  }
}

}  // namespace
}  // namespace cluxel::mapping
