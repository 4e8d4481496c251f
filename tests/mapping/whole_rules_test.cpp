// SPDX-License-Identifier: Apache-2.0
// Changes name the SPARQL rules that they evaluate for the whole map, and no others.
#include "mapping/inference/whole_rules.hpp"

#include <gmock/gmock.h>

#include "mapping/change/statement_change.hpp"
#include "mapping/map_change_fixture.hpp"
#include "mapping/stated_builds.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const std::string kCountingRule = "count.rq";

/// A map of two scans, of which a rule counts what it calls a class.
class WholeRules : public MapChange {
 protected:
  void SetUp() override { build({{0, 0}, {1, 0}}); }

  ChangeReport count(const std::string& class_name) {
    MapInputs counting = *inputs;
    counting.sparql_rules.push_back({kCountingRule,
                                     "PREFIX clx: <https://w3id.org/cluxel/ontology#> "
                                     "CONSTRUCT { <https://example.org/site> <https://example.org/has> ?n } WHERE { "
                                     "{ SELECT (COUNT(?thing) AS ?n) WHERE { ?thing a clx:" +
                                         class_name + " } } }"});
    return applyInputs(map(), always(counting), {}, notes);
  }
  /// States something of the first object that is no ground.
  ChangeReport state(StatementKind kind, const Term& value) {
    const MapReader reader(map());
    const auto object = std::find_if(reader.objects().begin(), reader.objects().end(),
                                     [&](const auto& one) { return one.class_iri != vocabulary::clx("Ground"); });
    if (object == reader.objects().end()) throw std::logic_error("the campus has ground alone");
    const std::string property = kind == StatementKind::Fact ? vocabulary::rdfs("label") : "";
    const Statement statement{kind, property, value, reader.anchorOf(object->id), {}};
    return changeStatements(map(), {{statement}, {}, "anna"}, {}, notes);
  }

  StatementNotes notes;
  const WholeRule kCounting{kCountingRule, "it aggregates over the map"};
  const std::string kNote = "count.rq is evaluated for the whole map at each change: it aggregates over the map\n";
};

TEST_F(WholeRules, AreNamedByASmallChangeAndByALargeOne) {
  EXPECT_THAT(count("Object").rules_evaluated_whole, ElementsAre(kCounting));
  notes.all.clear();
  EXPECT_THAT(state(StatementKind::Is, Term::iri(vocabulary::clx("StreetLamp"))).rules_evaluated_whole,
              ElementsAre(kCounting));
  EXPECT_THAT(notes.all, HasSubstr(kNote));
  notes.all.clear();
  const ChangeReport large = extendMap(map(), posed({{2, 0}, {3, 0}}), {.batch_points = 1}, notes);
  EXPECT_THAT(large.rules_evaluated_whole, ElementsAre(kCounting)) << "once, though there are two commits";
  const std::size_t first = notes.all.find(kNote);
  ASSERT_NE(first, std::string::npos) << notes.all;
  EXPECT_EQ(notes.all.find(kNote, first + 1), std::string::npos) << notes.all;
}

TEST_F(WholeRules, AreNotNamedWhereNothingThatTheyReadHasChanged) {
  count("TrafficLight");
  notes.all.clear();
  EXPECT_THAT(state(StatementKind::Fact, Term::literal("old oak")).rules_evaluated_whole, IsEmpty());
  EXPECT_THAT(notes.all, Not(HasSubstr("is evaluated for the whole map")));
}

TEST_F(WholeRules, AreNoneOfTheShippedOnes) {
  EXPECT_THAT(extend(2, 0).rules_evaluated_whole, IsEmpty());
  EXPECT_THAT(retract(2).rules_evaluated_whole, IsEmpty());
}

TEST_F(WholeRules, ThatReadWhatTheyDeriveAreNamed) {
  MapInputs reaching = *inputs;
  reaching.sparql_rules.push_back({"reach.rq",
                                   "PREFIX clx: <https://w3id.org/cluxel/ontology#> CONSTRUCT { ?a clx:reaches ?c } "
                                   "WHERE { ?a clx:near ?c FILTER NOT EXISTS { ?a clx:reaches ?c . ?a clx:minX 3 } }"});
  const WholeRule reaches{"reach.rq", "it reads what it derives"};
  EXPECT_THAT(applyInputs(map(), always(reaching), {}, silence()).rules_evaluated_whole, ElementsAre(reaches));
  EXPECT_THAT(extend(2, 0).rules_evaluated_whole, ElementsAre(reaches));
}

}  // namespace
}  // namespace cluxel::mapping
