// SPDX-License-Identifier: Apache-2.0
// A generated map in the vocabulary of built maps, for the shipped questions. Literals are in canonical form.
#include <random>

#include "rdf/vocabulary.hpp"
#include "sparql/support/generated_map_fixture.hpp"

namespace cluxel::test {

using namespace rdf;

namespace {

using vocabulary::clx;

class SurveyMaker {
 public:
  SurveyMaker(std::uint32_t seed, int objects) : random_(seed), objects_(objects) {}

  std::vector<Quad> make() {
    for (const char* name : {"Vehicle", "SmallObject"}) {
      quads_.push_back({Term::iri(clx(name)), Term::iri(clx("mobility")), Term::iri(clx("Movable")),
                        Term::iri(vocabulary::kGraphOntology)});
    }
    for (int i = 0; i < objects_; ++i) addObject(i);
    return std::move(quads_);
  }

 private:
  int upTo(int limit) { return static_cast<int>(random_() % static_cast<std::uint32_t>(limit)); }
  bool chance(int percent) { return upTo(100) < percent; }
  static Term object(int number) { return Term::iri(std::string(kMadeObject) + std::to_string(number)); }
  void add(const Term& subject, const std::string& predicate, const Term& value) {
    quads_.push_back({subject, Term::iri(predicate), value, Term::iri(vocabulary::kGraphObserved)});
  }
  /// A decimal with one digit, without a trailing zero.
  Term tenths(int value) {
    const std::string sign = value < 0 ? "-" : "";
    const int size = value < 0 ? -value : value;
    const std::string text = sign + std::to_string(size / 10) + (size % 10 == 0 ? "" : "." + std::to_string(size % 10));
    return Term::literal(text, vocabulary::xsd("decimal"));
  }
  void addPart(const Term& whole, int number, const char* type) {
    const Term part = Term::iri(std::string(kMadeObject) + std::to_string(number) + "/part");
    add(whole, clx("hasPart"), part);
    add(part, vocabulary::rdf("type"), Term::iri(clx(type)));
    add(part, clx("top"), tenths(20 + upTo(60)));
    add(part, clx("width"), tenths(1 + upTo(8)));
  }
  void addObject(int number) {
    static const char* const classes[] = {"Tree",    "Tree",        "StreetSign", "StreetLamp",
                                          "Vehicle", "SmallObject", "Building"};
    const char* type = classes[upTo(7)];
    const Term self = object(number);
    add(self, vocabulary::rdf("type"), Term::iri(clx(type)));
    // Never 0, because 0.0 * 0.0 is an error in oxigraph 0.5.11.
    for (const char* name : {"x", "y", "z", "heading"}) add(self, clx(name), tenths(2 * upTo(200) - 199));
    for (const char* name : {"height", "top", "length", "width"}) add(self, clx(name), tenths(1 + upTo(120)));
    add(self, clx("confidence"), tenths(1 + upTo(9)));
    if (chance(90)) add(self, clx("rule"), Term::literal(std::string("rules/") + type));
    for (int n = upTo(3); n > 0; --n) add(self, clx("near"), object(upTo(objects_)));
    if (chance(60)) addPart(self, number, chance(50) ? "LampHead" : "TreeTrunk");
    for (int k = upTo(3); k >= 0; --k) {
      const Term seen = Term::iri(std::string(kMadeObject) + std::to_string(number) + "/seen" + std::to_string(k));
      add(seen, std::string(vocabulary::kSosa) + "hasFeatureOfInterest", self);
      add(seen, clx("pointCount"), Term::integer(upTo(500)));
    }
  }

  std::mt19937 random_;
  int objects_;
  std::vector<Quad> quads_;
};

}  // namespace

std::vector<Quad> surveyedMap(std::uint32_t seed, int objects) {
  return SurveyMaker(seed, objects).make();
}

}  // namespace cluxel::test
