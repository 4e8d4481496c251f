// SPDX-License-Identifier: Apache-2.0
// The generated map: classes in the proportions of a street, neighbours within a street's length.
#include "sparql_data.hpp"

#include <array>
#include <random>
#include <string>

#include "rdf/vocabulary.hpp"

namespace cluxel::bench {
namespace {

using namespace rdf::vocabulary;

struct ClassShare {
  const char* name;
  unsigned per_mille;
  double min_height_m, max_height_m;
};

constexpr std::array<ClassShare, 8> kClasses = {{{"Tree", 330, 2.5, 18},
                                                 {"Bush", 250, 0.4, 2.5},
                                                 {"SmallObject", 180, 0.2, 1.5},
                                                 {"Vehicle", 100, 1.3, 3.2},
                                                 {"StreetLamp", 50, 3, 10},
                                                 {"Building", 40, 3, 25},
                                                 {"StreetSign", 30, 1.8, 4},
                                                 {"UtilityPole", 20, 6, 12}}};
constexpr unsigned kTriplesPerObject = 39;  // counted: what one object adds on average

class Generator {
 public:
  Generator(std::uint64_t triples, const std::function<void(const Quad&)>& take)
      : take_(take), objects_(triples / kTriplesPerObject) {}

  void run() {
    ontology();
    const std::uint64_t clouds = objects_ / 400 + 4;
    for (std::uint64_t i = 0; i < clouds; ++i) {
      add(cloud(i), clx("time"), Term::integer(static_cast<std::int64_t>(1'700'000'000 + 10 * i)));
      add(cloud(i), rdf::vocabulary::rdf("type"), Term::iri(clx("Cloud")));
    }
    for (std::uint64_t i = 0; i < objects_; ++i) object(i, clouds);
  }

 private:
  void add(const Term& s, const std::string& p, const Term& o, std::string_view graph = kGraphObserved) {
    take_({s, Term::iri(p), o, Term::iri(graph)});
  }
  unsigned upTo(unsigned limit) { return static_cast<unsigned>(random_() % limit); }
  Term object(std::uint64_t i) const { return Term::iri(std::string(kMap) + "object/" + std::to_string(i)); }
  Term cloud(std::uint64_t i) const { return Term::iri(std::string(kMap) + "cloud/" + std::to_string(i)); }
  /// Centimetres as a decimal.
  static Term metres(long centimetres) {
    std::string text = std::to_string(centimetres / 100) + ".";
    const long rest = std::labs(centimetres % 100);
    if (rest < 10) text += "0";
    return Term::literal(text + std::to_string(rest), xsd("decimal"));
  }

  void ontology() {
    const auto sub = [this](const char* lower, const char* upper) {
      add(Term::iri(clx(lower)), rdfs("subClassOf"), Term::iri(clx(upper)), kGraphOntology);
      add(Term::iri(clx(lower)), rdfs("label"), Term::langLiteral(lower, "en"), kGraphOntology);
    };
    for (const char* name : {"Tree", "Bush"}) sub(name, "Vegetation");
    for (const char* name : {"StreetLamp", "StreetSign", "UtilityPole"}) sub(name, "TrafficFurniture");
    for (const char* name : {"Vegetation", "TrafficFurniture", "Building"}) sub(name, "Static");
    for (const char* name : {"Vehicle", "SmallObject"}) sub(name, "Movable");
    sub("Static", "Feature");
    sub("Movable", "Feature");
  }

  const ClassShare& pickClass() {
    unsigned at = upTo(1000);
    for (const ClassShare& share : kClasses) {
      if (at < share.per_mille) return share;
      at -= share.per_mille;
    }
    return kClasses[0];
  }

  void object(std::uint64_t i, std::uint64_t clouds) {
    const ClassShare& share = pickClass();
    const Term self = object(i);
    const std::string name = share.name;
    add(self, rdf::vocabulary::rdf("type"), Term::iri(clx(name)));
    add(self, rdf::vocabulary::rdf("type"), Term::iri(clx("Feature")), kGraphInferred);
    // A field of objects some metres apart; it grows with their number.
    const auto side = static_cast<std::uint64_t>(std::max(1.0, std::sqrt(static_cast<double>(objects_))));
    const long x = static_cast<long>(i % side * 400 + upTo(400)), y = static_cast<long>(i / side * 400 + upTo(400));
    const long height = static_cast<long>(share.min_height_m * 100) +
                        upTo(static_cast<unsigned>((share.max_height_m - share.min_height_m) * 100));
    add(self, clx("x"), metres(x));
    add(self, clx("y"), metres(y));
    add(self, clx("z"), metres(static_cast<long>(upTo(300))));
    add(self, clx("height"), metres(height));
    add(self, clx("confidence"), Term::literal("0." + std::to_string(50 + upTo(50)), xsd("decimal")));
    add(self, rdfs("label"),
        Term::literal(name == "StreetSign" ? "street sign " + std::to_string(i) : name + " " + std::to_string(i)));
    add(self, std::string(kGeo) + "hasGeometry", Term::iri(self.text + "/geometry"));
    add(Term::iri(self.text + "/geometry"), std::string(kGeo) + "asWKT",
        Term::literal("POINT(" + metres(x).text + " " + metres(y).text + ")", std::string(kGeo) + "wktLiteral"));
    if (name == "StreetSign" && upTo(100) < 60) {
      add(self, clx("signText"), Term::literal("Platz " + std::to_string(upTo(1000))));
    }
    if (name == "Tree") add(self, clx("crownWidth"), metres(100 + static_cast<long>(upTo(900))));
    if (i % 50 != 49) add(self, clx("onSamePath"), object((i + 1) % objects_));
    for (unsigned k = 0; k < 2 + upTo(3); ++k) {
      const std::uint64_t other = (i + 1 + upTo(12)) % objects_;
      add(self, clx("near"), object(other));
      if (upTo(2) == 0) add(object(other), clx("near"), self);
    }
    primitives(i, self, x, y);
    observations(i, self, clouds);
  }

  void primitives(std::uint64_t i, const Term& self, long x, long y) {
    constexpr std::array<const char*, 5> kLabels = {"HorizontalPlane", "VerticalPlane", "Column", "SmallStructure",
                                                    "Scatter"};
    for (unsigned k = 0; k < 2; ++k) {
      const Term primitive = Term::iri(std::string(kMap) + "primitive/" + std::to_string(2 * i + k));
      add(self, clx("hasPrimitive"), primitive);
      add(primitive, rdf::vocabulary::rdf("type"), Term::iri(clx("Primitive")));
      add(primitive, clx("label"), Term::iri(clx(kLabels[upTo(5)])));
      add(primitive, clx("probability"), Term::literal("0." + std::to_string(upTo(900) + 100), xsd("decimal")));
      add(primitive, clx("minX"), metres(x - static_cast<long>(upTo(100))));
      add(primitive, clx("minY"), metres(y - static_cast<long>(upTo(100))));
      add(primitive, clx("points"), Term::integer(upTo(5000)));
      if (upTo(2) == 0) add(primitive, clx("area"), metres(static_cast<long>(upTo(2000))));
    }
  }

  void observations(std::uint64_t i, const Term& self, std::uint64_t clouds) {
    for (unsigned k = 0; k < 1 + upTo(2); ++k) {
      const Term seen = Term::iri(std::string(kMap) + "observation/" + std::to_string(i) + "-" + std::to_string(k));
      add(seen, rdf::vocabulary::rdf("type"), Term::iri(std::string(kSosa) + "Observation"));
      add(seen, std::string(kSosa) + "hasFeatureOfInterest", self);
      add(seen, clx("inCloud"), cloud((i / 400 + k) % clouds));
      add(seen, clx("pointCount"), Term::integer(upTo(3000)));
    }
  }

  const std::function<void(const Quad&)>& take_;
  std::uint64_t objects_;
  std::mt19937 random_{20240607};
};

}  // namespace

void generateMap(std::uint64_t triples, const std::function<void(const Quad&)>& take) {
  Generator(triples, take).run();
}

}  // namespace cluxel::bench
