// SPDX-License-Identifier: Apache-2.0
// What other rules would make of a map: the posted text is tried and forgotten.
#include <nlohmann/json.hpp>

#include "serve/http/media_types.hpp"
#include "serve/http/refusal.hpp"
#include "serve/resources/map_resources.hpp"
#include "serve/resources/sparql_endpoint.hpp"
#include "tasks/rule_trial/rule_difference.hpp"

namespace cluxel::serve {

HttpResponse answerRuleTrial(ServedMap& map, const ResourceRequest& asked, const std::string& token) {
  requireToken(asked.request, token, "a trial of rules");
  requireKnown(asked.target.parameters, {});
  const std::string type = mediaTypeOf(asked.request.header("content-type"));
  if (type != "application/yaml" && type != "text/plain")
    throw Refusal(415, "send the rules as application/yaml or text/plain");
  std::string text;
  map.withReader([&](const mapping::MapReader& reader) {
    const rules::RuleSet rules = tasks::rulesForMap(reader, "posted.rules.yaml", asked.request.body);
    text = jsonOf(tasks::trialOf(reader, rules));
  });
  return {200, "application/json", text + "\n", {}};
}

}  // namespace cluxel::serve
