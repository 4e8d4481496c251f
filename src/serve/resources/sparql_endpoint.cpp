// SPDX-License-Identifier: Apache-2.0
// Tells the operations of the protocol apart and runs them.
#include "serve/resources/sparql_endpoint.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/ascii.hpp"
#include "cluxel/error.hpp"
#include "mapping/change/map_update.hpp"
#include "serve/http/media_types.hpp"
#include "serve/http/refusal.hpp"
#include "serve/resources/answer_body.hpp"
#include "serve/resources/service_description.hpp"
#include "sparql/syntax/parser.hpp"

namespace cluxel::serve {

namespace {

/// One operation as the protocol gives it. At most one of the texts is there.
struct Operation {
  std::optional<std::string> query, update;
  Parameters parameters;
};

constexpr const char* kPostTypes =
    "POST takes application/x-www-form-urlencoded with query= or update=, application/sparql-query, or "
    "application/sparql-update";

Operation postedOperation(const HttpRequest& request, const Target& target) {
  const std::string type = mediaTypeOf(request.header("content-type"));
  const std::string charset = charsetOf(request.header("content-type"));
  if (!charset.empty() && charset != "utf-8" && charset != "us-ascii")
    throw Refusal(415, "charset " + charset + ": send UTF-8");
  Operation operation;
  operation.parameters = target.parameters;
  if (type == "application/sparql-query") {
    operation.query = request.body;
  } else if (type == "application/sparql-update") {
    operation.update = request.body;
  } else if (type == "application/x-www-form-urlencoded") {
    const Parameters form = parseForm(request.body);
    operation.parameters.insert(operation.parameters.end(), form.begin(), form.end());
  } else {
    throw Refusal(
        415, (type.empty() ? std::string("the Content-Type is missing") : "Content-Type " + type) + ": " + kPostTypes);
  }
  return operation;
}

Operation operationOf(const HttpRequest& request, const Target& target) {
  Operation operation;
  if (request.method == "POST")
    operation = postedOperation(request, target);
  else
    operation.parameters = target.parameters;
  const auto query = valueOf(operation.parameters, "query"), update = valueOf(operation.parameters, "update");
  const int texts = operation.query.has_value() + operation.update.has_value() + query.has_value() + update.has_value();
  if (texts > 1) throw Refusal(400, "more than one query or update is given; send one a request");
  if (update && request.method != "POST") throw Refusal(400, "an update must be sent by POST");
  if (query) operation.query = query;
  if (update) operation.update = update;
  if (texts == 0 && (request.method == "POST" || !operation.parameters.empty()))
    throw Refusal(400, "the parameter query (or update, by POST) is missing");
  return operation;
}

HttpResponse runQuery(const ServedMap& map, const HttpRequest& request, const Operation& operation,
                      const RequestLimits& limits) {
  sparql::QueryOptions options = queryOptions(limits, request);
  options.default_graphs = valuesOf(operation.parameters, "default-graph-uri");
  options.named_graphs = valuesOf(operation.parameters, "named-graph-uri");
  return answerQuery(map.quads(), *operation.query, options, {}, formatRequestOf(request, operation.parameters),
                     limits);
}

/// The protocol forbids its own graph parameters beside USING.
void refuseUsing(const std::string& update) {
  sparql::SparqlParseOptions options;
  options.file = "update";
  options.prefixes = sparql::mapPrefixes();
  const sparql::ast::Update parsed = sparql::parseUpdate(update, options);
  for (const sparql::ast::UpdateOperation& operation : parsed.operations) {
    const auto* modify = std::get_if<sparql::ast::Modify>(&operation.value);
    if (modify != nullptr && (modify->with || !modify->using_clause.empty()))
      throw Refusal(400, "using-graph-uri and using-named-graph-uri cannot be given beside USING or WITH");
  }
}

HttpResponse runUpdate(ServedMap& map, const Operation& operation, const RequestLimits& limits) {
  sparql::UpdateOptions options;
  options.query = queryOptions(limits);
  options.query.source_name = "update";
  options.query.default_graphs = valuesOf(operation.parameters, "using-graph-uri");
  options.query.named_graphs = valuesOf(operation.parameters, "using-named-graph-uri");
  if (!options.query.default_graphs.empty() || !options.query.named_graphs.empty()) refuseUsing(*operation.update);
  options.load = [](const std::string& iri) -> std::vector<Quad> {
    throw Error(ErrorKind::InvalidArgument,
                "LOAD <" + iri + "> is refused: a service reads no file for a request; send the quads by INSERT DATA");
  };
  map.release();
  ProgressSink silence;
  const sparql::UpdateReport report = mapping::updateMap(map.file(), *operation.update, options, silence);
  const nlohmann::ordered_json json{{"inserted", report.inserted}, {"deleted", report.deleted}};
  return {200, "application/json", json.dump() + "\n", {}};
}

/// Takes the same time wherever the texts differ.
bool isEqual(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0U : 1U;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return difference == 0;
}

}  // namespace

void requireToken(const HttpRequest& request, const std::string& token, const std::string& what) {
  if (token.empty()) throw Refusal(403, what + " needs a token, and this service was started without one");
  const std::string sent = request.header("authorization");
  constexpr std::string_view scheme = "bearer ";
  const bool is_bearer = sent.size() > scheme.size() && lowerCase(sent).starts_with(scheme);
  if (is_bearer && isEqual(std::string_view(sent).substr(scheme.size()), token)) return;
  throw Refusal(401,
                is_bearer ? "the token is not the one of this service"
                          : what + " needs the service's token; send 'Authorization: Bearer TOKEN'",
                {{"WWW-Authenticate", R"(Bearer realm="cluxel")"}});
}

HttpResponse answerSparql(ServedMap& map, const HttpRequest& request, const Target& target, const std::string& endpoint,
                          const ServiceOptions& options) {
  const Operation operation = operationOf(request, target);
  if (operation.update) {
    requireToken(request, options.token, "an update");
    return runUpdate(map, operation, options.request);
  }
  if (operation.query) return runQuery(map, request, operation, options.request);
  return answerResult(serviceDescription(map.quads(), endpoint, !options.token.empty()),
                      formatRequestOf(request, target.parameters), options.request);
}

}  // namespace cluxel::serve
