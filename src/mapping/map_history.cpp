// SPDX-License-Identifier: Apache-2.0
// Builds as PROV activities.
#include "mapping/map_history.hpp"

#include <nlohmann/json.hpp>

#include "cluxel/knowledge/quad_store.hpp"
#include "cluxel/knowledge/vocabulary.hpp"
#include "mapping/map_facts.hpp"

namespace cluxel {

namespace {

/// A file's name may be no UTF-8, of which all text in a map is.
Term nameText(const std::string& name) {
  using Json = nlohmann::json;
  return Term::literal(Json::parse(Json(name).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>());
}

std::string prov(std::string_view local) {
  return std::string(vocabulary::kProv).append(local);
}

}  // namespace

void addBuildActivity(WriteTransaction& transaction, const std::vector<Cloud>& clouds, const MapInputs& inputs,
                      double started_s, double ended_s) {
  QuadWriter writer(transaction);
  const Term graph = Term::iri(vocabulary::kGraphHistory);
  ContentHasher hasher;
  hasher.add(inputs.hash()).add(started_s).add(ended_s);
  const Term activity = Term::iri(std::string(vocabulary::kMap) + "activity/" + hasher.finish().hex());
  const auto add = [&](const Term& subject, const std::string& property, const Term& object) {
    writer.add(Quad{subject, Term::iri(property), object, graph});
  };
  const auto time = [](double seconds) { return Term::literal(dateTimeText(seconds), vocabulary::xsd("dateTime")); };
  add(activity, vocabulary::rdf("type"), Term::iri(prov("Activity")));
  add(activity, prov("startedAtTime"), time(started_s));
  add(activity, prov("endedAtTime"), time(ended_s));
  add(activity, vocabulary::clx("inputsHash"), Term::literal(inputs.hash().hex()));
  add(activity, vocabulary::clx("modelFile"), nameText(inputs.model.name));
  for (const Cloud& cloud : clouds) {
    const Term subject = Term::iri(iriOfCloud(cloud.id));
    add(activity, prov("used"), subject);
    add(subject, vocabulary::clx("sourceFile"), nameText(cloud.source));
  }
  writer.flush();
}

}  // namespace cluxel
