// SPDX-License-Identifier: Apache-2.0
// The SPARQL 1.1 Protocol on one map: queries by GET and both POSTs, updates by both POSTs.
#pragma once

#include <string>

#include "serve/http/http_message.hpp"
#include "serve/http/url.hpp"
#include "serve/served_map.hpp"
#include "serve/service_options.hpp"

namespace cluxel::serve {

/// Answers a query, performs an update, or describes the service when there is neither. `endpoint` is the absolute URL
/// of the service. Updates change the operator's statements only, and need the token. Throws Refusal and Error.
HttpResponse answerSparql(ServedMap& map, const HttpRequest& request, const Target& target, const std::string& endpoint,
                          const ServiceOptions& options);

/// Throws Refusal: 403 when the service has no token, 401 without the right one. `what` needs it: "an update".
void requireToken(const HttpRequest& request, const std::string& token, const std::string& what);

}  // namespace cluxel::serve
