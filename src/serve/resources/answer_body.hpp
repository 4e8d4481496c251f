// SPDX-License-Identifier: Apache-2.0
// Runs a query and makes the whole body of the response, so that a slow client holds no snapshot.
#pragma once

#include <string>
#include <vector>

#include "serve/http/http_message.hpp"
#include "serve/http/url.hpp"
#include "serve/service_options.hpp"
#include "sparql/query_engine.hpp"
#include "sparql/results/result_writer.hpp"

namespace cluxel::serve {

/// A media type that results are written in, and its short name for the parameter `format`.
struct ResultOffer {
  std::string media_type, name;
  sparql::ResultFormat format;
};

/// The offers for solutions and booleans, or for graphs, best first.
const std::vector<ResultOffer>& offersFor(bool is_graph);

/// What the client wants: the parameter `format`, else the header Accept.
struct FormatRequest {
  std::string accept, format;
};
FormatRequest formatRequestOf(const HttpRequest& request, const Parameters& parameters);
/// Throws Refusal (406) when the client takes none, and (400) for an unknown format.
const ResultOffer& chooseOffer(const FormatRequest& requested, bool is_graph);

/// A body that grows up to a limit; add() throws Error (BudgetExceeded) beyond it.
class LimitedBody {
 public:
  explicit LimitedBody(std::uint64_t max_bytes) : max_bytes_(max_bytes) {}
  void add(std::string_view piece);
  std::string take() { return std::move(text_); }

 private:
  std::uint64_t max_bytes_;
  std::string text_;
};

/// The options of a query or update within the limits of a request.
sparql::QueryOptions queryOptions(const RequestLimits& limits);
/// Those of a query, which ends by Refusal (499) when the client of `request` hangs up.
sparql::QueryOptions queryOptions(const RequestLimits& limits, const HttpRequest& request);

/// The header of each warning about a query: text in ASCII, other bytes and % percent-encoded.
inline constexpr const char* kWarningHeader = "Cluxel-Warning";

/// The header that names the commit of the map that the answer is of.
inline constexpr const char* kStateHeader = "Cluxel-State";
/// Its value where a commit came while the answer was made, also by the request itself.
inline constexpr const char* kChangedState = "changed";

/// Runs a query with its parameters bound. Warnings about it stand in headers, and below a table.
HttpResponse answerQuery(const rdf::QuadReader& reader, const std::string& text, const sparql::QueryOptions& options,
                         const std::vector<sparql::Binding>& bindings, const FormatRequest& requested,
                         const RequestLimits& limits);
/// Writes a result that is there already.
HttpResponse answerResult(const sparql::QueryResult& result, const FormatRequest& requested,
                          const RequestLimits& limits);

}  // namespace cluxel::serve
