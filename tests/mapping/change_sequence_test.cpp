// SPDX-License-Identifier: Apache-2.0
// A state machine: after any sequence of operations a map is the build from scratch of the inputs that it then has.
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <set>

#include "mapping/build/operator_statements.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/map_merge.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/long_tests.hpp"
#include "mapping/mixed_scans.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

/// A map, the inputs that it should have, and operations that change both.
class ChangeSequence {
 public:
  ChangeSequence(unsigned seed, const MixedScans& scans, const std::vector<MapInputs>& inputs)
      : random_(seed), scans_(scans), inputs_(inputs) {
    there_ = {{0, std::nullopt}, {1, std::nullopt}};
    build(there_, {}, map());
  }

  /// Does one operation and returns its name. The first one makes statements, so that even a short sequence has some.
  std::string step() {
    // Statements are made most often, so that many hold together.
    using Operation = void (ChangeSequence::*)();
    constexpr std::size_t kState = 4;
    static const std::vector<std::pair<std::string, Operation>> operations{
        {"extend", &ChangeSequence::extend},       {"retract", &ChangeSequence::retract},
        {"repose", &ChangeSequence::repose},       {"rules apply", &ChangeSequence::applyRules},
        {"state", &ChangeSequence::state},         {"state", &ChangeSequence::state},
        {"update", &ChangeSequence::update},       {"withdraw", &ChangeSequence::withdraw},
        {"delete", &ChangeSequence::deleteIt},     {"merge", &ChangeSequence::merge},
        {"copy", &ChangeSequence::copyOrMergeCopy}};
    const auto& [name, operation] = operations[stated_ == 0 ? kState : below(operations.size())];
    threads_ = 1 + static_cast<unsigned>(below(2));
    (this->*operation)();
    return name;
  }

  void expectBuildFromScratch(const std::string& after) {
    std::set<std::string> stored;
    for (const Quad& quad : operatorStatements(MapReader(map()).quads())) stored.insert(toNQuads(quad));
    EXPECT_TRUE(stored == texts()) << after << " lost statements or made some";
    const fs::path fresh = folder_.path() / "fresh.clx";
    build(there_, statements(), fresh);
    EXPECT_TRUE(canonicalText(map()) == canonicalText(fresh)) << "after " << after;
    EXPECT_EQ(MapReader(map()).overruled().size(), MapReader(fresh).overruled().size()) << "after " << after;
  }

  std::size_t stated() const { return stated_; }
  std::size_t applied() const { return applied_; }

 private:
  using Places = std::map<std::size_t, std::optional<int>>;  ///< scan → number of its pose; absent: as measured

  fs::path map() const { return folder_.path() / "map.clx"; }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(random_() % count); }
  bool oneIn(std::size_t count) { return below(count) == 0; }
  ChangeParams params(bool dry_run = false) const {
    return {threads_, batch_points_, dry_run, stage_points_, true, 1.0};  // windows of any size
  }

  ScanSet scansAt(const Places& places) {
    std::vector<MixedScans::Place> chosen(places.begin(), places.end());
    std::shuffle(chosen.begin(), chosen.end(), random_);
    return scans_.at(chosen, folder_.path());
  }
  void build(const Places& places, const std::vector<Quad>& statements, const fs::path& file) {
    const unsigned threads = 1 + static_cast<unsigned>(below(2));
    fs::remove(file);
    buildMap(scansAt(places), inputs_[rules_], file, {.threads = threads, .force = true, .statements = statements},
             silence());
  }

  std::vector<Quad> statements() const {
    std::vector<Quad> all;
    for (const auto& [id, quads] : statements_) all.insert(all.end(), quads.begin(), quads.end());
    return all;
  }
  std::set<std::string> texts() const {
    std::set<std::string> all;
    for (const Quad& quad : statements()) all.insert(toNQuads(quad));
    return all;
  }
  void remember(const Statement& statement) {
    stated_ += statements_.emplace(rdf::iriOfStatement(statement.id()), quadsOf(statement)).second ? 1 : 0;
  }

  /// A dry run changes nothing.
  template <typename Change>
  void changed(const Change& change) {
    if (oneIn(4)) {
      const std::string before = canonicalText(map());
      change(params(true));
      EXPECT_TRUE(canonicalText(map()) == before) << "a dry run changed the map";
    }
    const bool compares_threads = isLong() || oneIn(4);
    const fs::path before = folder_.path() / "before.clx", other = folder_.path() / "other_threads.clx";
    if (compares_threads) fs::copy_file(map(), before, fs::copy_options::overwrite_existing);
    const ChangeReport report = change(params());
    if (compares_threads) {
      fs::rename(map(), other);
      fs::rename(before, map());
      threads_ = 3 - threads_;
      change(params());
      EXPECT_TRUE(canonicalText(map()) == canonicalText(other)) << "with 1 and 2 threads";
    }
    for (const StatementOutcome& outcome : report.statements)
      applied_ += outcome.effect == StatementEffect::Applied ? 1 : 0;
  }

  void extend() {
    Places added;
    for (std::size_t i = 0; i < scans_.size(); ++i)
      if (!there_.contains(i) && oneIn(2)) added[i] = somePose();
    if (added.empty()) return;
    if (oneIn(2)) added.insert(*there_.begin());  // is passed over
    batch_points_ = oneIn(2) ? 1 : 20'000'000;
    stage_points_ = oneIn(2) ? 1 : 20'000'000;
    changed([&](const ChangeParams& params) { return extendMap(map(), scansAt(added), params, silence()); });
    there_.insert(added.begin(), added.end());
  }
  void retract() {
    if (there_.size() < 2) return;
    const auto gone = std::next(there_.begin(), static_cast<std::ptrdiff_t>(below(there_.size())));
    const ScanId id = scans_.idOf(gone->first);
    changed([&](const ChangeParams& params) { return retractScans(map(), {id}, params, silence()); });
    there_.erase(gone);
  }
  void repose() {
    std::vector<ScanPose> poses;
    for (auto& [scan, place] : there_)
      if (oneIn(2)) {
        place = static_cast<int>(below(3));
        poses.push_back({scans_.idOf(scan), scans_.poseOf(scan, *place)});
      }
    changed([&](const ChangeParams& params) { return moveScans(map(), poses, params, silence()); });
  }
  void applyRules() {
    rules_ = below(inputs_.size());
    stage_points_ = oneIn(2) ? 2000 : 20'000'000;  // another model goes from part to part
    changed([&](const ChangeParams& params) {
      return applyInputs(
          map(), [&](const MapInputs&) { return inputs_[rules_]; }, params, silence());
    });
  }

  std::optional<int> somePose() { return oneIn(2) ? std::nullopt : std::optional(static_cast<int>(below(3))); }

  /// Some statement about an object or a region of the map.
  Statement some(const MapReader& reader) {
    std::vector<const rules::SemanticObject*> things;
    for (const rules::SemanticObject& object : reader.objects())
      if (object.class_iri != vocabulary::clx("Ground")) things.push_back(&object);
    if (things.empty() || oneIn(6)) {
      const Eigen::Vector3d at = reader.clouds()[below(reader.clouds().size())].T_map_sensor.translation();
      const double x = at.x() + static_cast<double>(below(20)), y = at.y() + static_cast<double>(below(20));
      return {StatementKind::IgnoreRegion, "", {}, {}, regionAnchor(reader.clouds(), {{x, y}, {x + 6, y}, {x, y + 6}})};
    }
    const rules::SemanticObject& thing = *things[below(things.size())];
    const PointAnchor anchor = anchorOf(reader.stagesWithPoints(), thing);
    static const std::vector<std::string> classes{"Tree", "StreetSign", "Pole", "Vehicle", "StreetFurniture"};
    const Term class_iri = Term::iri(vocabulary::clx(classes[below(classes.size())]));
    switch (below(4)) {
      case 0:
        return {StatementKind::Is, "", class_iri, anchor, {}};
      case 1:
        return {StatementKind::IsNot, "", oneIn(2) ? class_iri : Term::iri(thing.class_iri), anchor, {}};
      case 2:
        return {StatementKind::Remove, "", {}, anchor, {}};
      default:
        return {StatementKind::Fact,
                vocabulary::rdfs("label"),
                Term::literal("no " + std::to_string(random_())),
                anchor,
                {}};
    }
  }
  void state() {
    StatementEdit edit;
    {
      const MapReader reader(map());
      for (std::size_t left = 1 + below(6); left > 0; --left) edit.added.push_back(some(reader));
    }
    edit.author = "anna";
    changed([&](const ChangeParams& params) { return changeStatements(map(), edit, params, silence()); });
    for (const Statement& statement : edit.added) remember(statement);
  }
  /// The IRI of some resource that was stated, if there is any.
  std::optional<std::string> someStated(bool of_statements) {
    std::vector<std::string> iris;
    for (const auto& [iri, quads] : statements_)
      if (iri.starts_with("https://example.org/") != of_statements) iris.push_back(iri);
    return iris.empty() ? std::nullopt : std::optional(iris[below(iris.size())]);
  }
  void withdraw() {
    const auto iri = someStated(true);
    if (!iri) return;
    const ContentHash id = ContentHash::fromHex(iri->substr(iri->rfind('/') + 1));
    changed([&](const ChangeParams& params) { return changeStatements(map(), {{}, {id}, "anna"}, params, silence()); });
    statements_.erase(*iri);
  }
  /// States by SPARQL: a fact about something else, or the class or a label of an object.
  void update() {
    const std::string label = "<" + vocabulary::rdfs("label") + ">";
    if (oneIn(2)) {
      const std::string iri = "https://example.org/" + std::to_string(below(5));
      const Quad quad{Term::iri(iri), Term::iri(vocabulary::rdfs("label")), Term::literal("place"),
                      Term::iri(vocabulary::kGraphOperator)};
      updateMap(map(), "INSERT DATA { <" + iri + "> " + label + " \"place\" }", {}, silence());
      statements_[iri] = {quad};
      return;
    }
    Statement statement;
    std::string object;
    {
      const MapReader reader(map());
      const rules::SemanticObject& thing = reader.objects()[below(reader.objects().size())];
      const bool is_class = oneIn(2) && thing.class_iri != vocabulary::clx("Ground");
      object = rdf::iriOfObject(thing.id);
      statement.points = anchorOf(reader.stagesWithPoints(), thing);
      statement.kind = is_class ? StatementKind::Is : StatementKind::Fact;
      statement.property = is_class ? "" : vocabulary::rdfs("comment");
      statement.value = is_class ? Term::iri(vocabulary::clx("UtilityPole")) : Term::literal("by update");
    }
    const std::string property = statement.property.empty() ? vocabulary::rdf("type") : statement.property;
    updateMap(map(), "INSERT DATA { <" + object + "> <" + property + "> " + toNTriples(statement.value) + " }", {},
              silence());
    remember(statement);
  }
  void deleteIt() {
    const auto iri = someStated(oneIn(2));
    if (!iri) return;
    updateMap(map(),
              "DELETE WHERE { GRAPH <" + std::string(vocabulary::kGraphOperator) + "> { <" + *iri + "> ?p ?o } }", {},
              silence());
    statements_.erase(*iri);
  }

  bool isOfSamePlaces(const Places& other) const {
    return std::all_of(other.begin(), other.end(), [&](const auto& place) {
      const auto known = there_.find(place.first);
      return known == there_.end() || known->second == place.second;
    });
  }
  /// Keeps a copy, or merges the copy of before: it brings back scans, but no statement that was withdrawn since.
  void copyOrMergeCopy() {
    const fs::path older = folder_.path() / "older.clx", merged = folder_.path() / "merged.clx";
    if (!older_ || older_->rules != rules_ || !isOfSamePlaces(older_->there)) {
      fs::copy_file(map(), older, fs::copy_options::overwrite_existing);
      older_ = Copy{there_, statements_, rules_};
      return;
    }
    mergeMaps({{map()}, {older}}, merged, {.change = params(), .use = std::nullopt, .force = true}, silence());
    fs::rename(merged, map());
    there_.insert(older_->there.begin(), older_->there.end());
    for (const auto& [iri, quads] : older_->statements)
      if (iri.starts_with("https://example.org/")) statements_[iri] = quads;
    older_.reset();
  }

  /// With a map of some of its scans, of others, and of some of its statements and others.
  void merge() {
    Places places;
    for (std::size_t i = 0; i < scans_.size(); ++i)
      if (oneIn(2)) places[i] = there_.contains(i) ? there_[i] : somePose();
    if (places.empty()) return;
    std::vector<Quad> shared;
    for (const auto& [iri, quads] : statements_)
      if (oneIn(2)) shared.insert(shared.end(), quads.begin(), quads.end());
    const fs::path other = folder_.path() / "other.clx", merged = folder_.path() / "merged.clx";
    build(places, shared, other);
    {
      const Statement statement = some(MapReader(other));
      changeStatements(other, {{statement}, {}, "bert"}, {}, silence());
      remember(statement);
    }
    std::vector<MapToMerge> maps{{map()}, {other}};
    if (oneIn(2)) std::swap(maps[0], maps[1]);
    mergeMaps(maps, merged, {.change = params(), .use = std::nullopt, .force = true}, silence());
    fs::rename(merged, map());
    there_.insert(places.begin(), places.end());
  }

  struct Copy {
    Places there;
    std::map<std::string, std::vector<Quad>> statements;
    std::size_t rules = 0;
  };

  std::mt19937 random_;
  std::optional<Copy> older_;
  const MixedScans& scans_;
  const std::vector<MapInputs>& inputs_;
  ScratchFolder folder_;
  Places there_;
  std::map<std::string, std::vector<Quad>> statements_;  ///< by subject
  std::size_t rules_ = 0, stated_ = 0, applied_ = 0;
  unsigned threads_ = 1;
  std::uint64_t batch_points_ = 20'000'000, stage_points_ = 20'000'000;
};

MapInputs replaced(MapInputs inputs, const std::string& from, const std::string& to) {
  std::string& text = inputs.rules.front().text;
  text.replace(text.find(from), from.size(), to);
  return inputs;
}

TEST(ChangeSequences, GiveTheMapOfABuildFromTheInputsAfterEachOperation) {
  const MixedScans scans;
  scans.expectAllKinds();
  const MapInputs shipped = shippedInputs();
  MapInputFiles files;
  files.model = "campus";
  const MapInputs other_model = readMapInputs(files, DataHome(test::sourceFolder()));
  const std::vector<MapInputs> inputs{shipped, other_model, replaced(shipped, "bush_top: 1.7 m", "bush_top: 1.2 m"),
                                      replaced(shipped, "group: { near: 1.5 m }", "group: { near: 0.2 m }")};
  std::size_t stated = 0, applied = 0;
  for (unsigned seed = 0; seed < (isLong() ? 6 : 1); ++seed) {
    ChangeSequence sequence(seed, scans, inputs);
    for (int i = 0; i < (isLong() ? 50 : 8) && !testing::Test::HasFailure(); ++i) {
      const std::string operation = sequence.step();
      sequence.expectBuildFromScratch(operation + " (seed " + std::to_string(seed) + ", step " + std::to_string(i) +
                                      ")");
    }
    stated += sequence.stated(), applied += sequence.applied();
  }
  EXPECT_GE(stated, isLong() ? 200U : 1U);
  EXPECT_GT(applied, stated / 2);
}

}  // namespace
}  // namespace cluxel::mapping
