// SPDX-License-Identifier: Apache-2.0
// Build runs as PROV activities.
#include "mapping/facts/map_history.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "base/utc_time.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/facts/map_facts.hpp"
#include "mapping/thing_history.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

namespace {

/// Replaces invalid UTF-8, which file names may contain and literals may not.
Term nameText(const std::string& name) {
  using Json = nlohmann::json;
  return Term::literal(Json::parse(Json(name).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>());
}

/// To a millisecond.
Term secondsLiteral(double seconds) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3f", seconds);
  return Term::literal(text.data(), rdf::vocabulary::xsd("decimal"));
}

/// The values of a property among the quads of one subject.
std::vector<std::string> valuesOf(const std::vector<Quad>& about, const std::string& property) {
  std::vector<std::string> values;
  for (const Quad& quad : about)
    if (quad.predicate.text == property) values.push_back(quad.object.text);
  return values;
}

}  // namespace

std::string addActivity(rdf::WriteTransaction& transaction, const Activity& run, const std::vector<Cloud>& clouds,
                        const MapInputs& inputs) {
  rdf::QuadWriter writer(transaction);
  const Term graph = Term::iri(rdf::vocabulary::kGraphHistory);
  ContentHasher hasher;
  hasher.add(inputs.hash()).add(run.started_s).add(run.ended_s);
  const Term activity = Term::iri(rdf::iriOfActivity(hasher.finish()));
  const auto add = [&](const Term& subject, const std::string& property, const Term& object) {
    writer.add(Quad{subject, Term::iri(property), object, graph});
  };
  const auto time = [](double seconds) {
    return Term::literal(dateTimeText(seconds), rdf::vocabulary::xsd("dateTime"));
  };
  add(activity, rdf::vocabulary::rdf("type"), Term::iri(provenance("Activity")));
  add(activity, provenance("startedAtTime"), time(run.started_s));
  add(activity, provenance("endedAtTime"), time(run.ended_s));
  add(activity, rdf::vocabulary::clx("operation"), Term::literal(run.operation));
  add(activity, rdf::vocabulary::clx("inputsHash"), Term::literal(inputs.hash().hex()));
  add(activity, rdf::vocabulary::clx("modelFile"), nameText(inputs.model.name));
  for (std::size_t i = 0; i < run.stage_s.size(); ++i) {
    const Term stage = Term::iri(activity.text + "/stage/" + std::to_string(i));
    add(activity, rdf::vocabulary::clx("hasStage"), stage);
    add(stage, rdf::vocabulary::rdfs("label"), Term::literal(run.stage_s[i].first));
    add(stage, rdf::vocabulary::clx("seconds"), secondsLiteral(run.stage_s[i].second));
  }
  for (const Cloud& cloud : clouds) {
    const Term subject = Term::iri(rdf::iriOfCloud(cloud.id));
    add(activity, provenance("used"), subject);
    add(subject, rdf::vocabulary::clx("sourceFile"), nameText(cloud.source));
  }
  writer.flush();
  return activity.text;
}

std::set<std::string> activitiesIn(const rdf::QuadReader& quads) {
  std::set<std::string> activities;
  forEachHistoryLink(quads, "startedAtTime",
                     [&](const Term& activity, const Term&) { activities.insert(activity.text); });
  return activities;
}

std::vector<RetractedScan> retractedScans(const rdf::ReadTransaction& transaction) {
  const rdf::QuadReader quads(transaction);
  std::map<scan::ScanId, RetractedScan> retracted;
  for (const std::string& activity : activitiesIn(quads)) {
    const std::vector<Quad> run = quadsAbout(quads, activity, rdf::vocabulary::kGraphHistory);
    if (valuesOf(run, rdf::vocabulary::clx("operation")) != std::vector<std::string>{"retract"}) continue;
    for (const std::string& cloud : valuesOf(run, provenance("used"))) {
      const auto id = hashIn(cloud, "cloud");
      if (!id || storedCloud(transaction, *id)) continue;  // it was added again
      RetractedScan& scan = retracted[*id];
      scan.id = *id;
      scan.sources =
          valuesOf(quadsAbout(quads, cloud, rdf::vocabulary::kGraphHistory), rdf::vocabulary::clx("sourceFile"));
      for (const std::string& time : valuesOf(run, provenance("endedAtTime"))) scan.time = std::max(scan.time, time);
    }
  }
  std::vector<RetractedScan> scans;
  for (auto& [id, scan] : retracted) scans.push_back(std::move(scan));
  return scans;
}

void addLineage(rdf::WriteTransaction& transaction, const std::string& activity_iri, const ObjectChanges& changes) {
  rdf::QuadWriter writer(transaction);
  const Term graph = Term::iri(rdf::vocabulary::kGraphHistory), activity = Term::iri(activity_iri);
  const auto add = [&](const ContentHash& subject, const std::string& property, const Term& object) {
    writer.add(Quad{Term::iri(rdf::iriOfObject(subject)), Term::iri(property), object, graph});
  };
  for (const auto* objects : {&changes.changed, &changes.split, &changes.joined})
    for (const DerivedObject& object : *objects) {
      for (const ContentHash& from : object.from)
        if (from != object.id)  // joined with objects of another map
          add(object.id, provenance("wasDerivedFrom"), Term::iri(rdf::iriOfObject(from)));
      add(object.id, provenance("wasGeneratedBy"), activity);
    }
  for (const ContentHash& gone : changes.gone) add(gone, provenance("wasInvalidatedBy"), activity);
  writer.flush();
}

void removeEndsOf(rdf::WriteTransaction& transaction, const std::vector<ContentHash>& present) {
  const rdf::QuadReader before(static_cast<const rdf::ReadTransaction&>(transaction));
  const auto ended = before.idOf(Term::iri(provenance("wasInvalidatedBy")));
  const auto history = before.idOf(Term::iri(rdf::vocabulary::kGraphHistory));
  if (!ended || !history) return;
  rdf::QuadWriter writer(transaction);
  for (const ContentHash& id : present) {
    const auto object = before.idOf(Term::iri(rdf::iriOfObject(id)));
    if (!object) continue;
    rdf::QuadCursor cursor = before.scan({.s = *object, .p = *ended, .o = {}, .g = *history});
    for (rdf::QuadIds quad; cursor.next(quad);) writer.remove(quad);
  }
  writer.flush();
}

}  // namespace cluxel::mapping
