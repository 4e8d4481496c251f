// SPDX-License-Identifier: Apache-2.0
// Build runs as PROV activities.
#include "mapping/facts/map_history.hpp"

#include <nlohmann/json.hpp>

#include "mapping/facts/map_facts.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

namespace {

/// Replaces invalid UTF-8, which file names may contain and literals may not.
Term nameText(const std::string& name) {
  using Json = nlohmann::json;
  return Term::literal(Json::parse(Json(name).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>());
}

std::string prov(std::string_view local) {
  return std::string(rdf::vocabulary::kProv).append(local);
}

}  // namespace

void addBuildActivity(rdf::WriteTransaction& transaction, const std::vector<Cloud>& clouds, const MapInputs& inputs,
                      double started_s, double ended_s) {
  rdf::QuadWriter writer(transaction);
  const Term graph = Term::iri(rdf::vocabulary::kGraphHistory);
  ContentHasher hasher;
  hasher.add(inputs.hash()).add(started_s).add(ended_s);
  const Term activity = Term::iri(rdf::iriOfActivity(hasher.finish()));
  const auto add = [&](const Term& subject, const std::string& property, const Term& object) {
    writer.add(Quad{subject, Term::iri(property), object, graph});
  };
  const auto time = [](double seconds) {
    return Term::literal(dateTimeText(seconds), rdf::vocabulary::xsd("dateTime"));
  };
  add(activity, rdf::vocabulary::rdf("type"), Term::iri(prov("Activity")));
  add(activity, prov("startedAtTime"), time(started_s));
  add(activity, prov("endedAtTime"), time(ended_s));
  add(activity, rdf::vocabulary::clx("inputsHash"), Term::literal(inputs.hash().hex()));
  add(activity, rdf::vocabulary::clx("modelFile"), nameText(inputs.model.name));
  for (const Cloud& cloud : clouds) {
    const Term subject = Term::iri(rdf::iriOfCloud(cloud.id));
    add(activity, prov("used"), subject);
    add(subject, rdf::vocabulary::clx("sourceFile"), nameText(cloud.source));
  }
  writer.flush();
}

}  // namespace cluxel::mapping
