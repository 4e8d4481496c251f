// SPDX-License-Identifier: Apache-2.0
// Results as bodies of responses.
#include "serve/resources/answer_body.hpp"

#include <algorithm>

#include "cluxel/error.hpp"
#include "serve/http/media_types.hpp"
#include "serve/http/refusal.hpp"

namespace cluxel::serve {

namespace {

std::string listOf(const std::vector<ResultOffer>& offers) {
  std::string list;
  for (const ResultOffer& offer : offers) list += (list.empty() ? "" : ", ") + offer.media_type;
  return list;
}

std::string contentTypeOf(const ResultOffer& offer) {
  const bool is_text = offer.media_type.starts_with("text/");
  return is_text ? offer.media_type + "; charset=utf-8" : offer.media_type;
}

HttpResponse responseWith(LimitedBody& body, const ResultOffer& offer) {
  return {200, contentTypeOf(offer), body.take(), {{"Vary", "Accept"}}};
}

/// Clients take a few KiB of headers.
constexpr std::size_t kMostWarnings = 8, kMostWarningBytes = 600;

/// One line of printable ASCII: what is none is percent-encoded, as the percent sign. A long one ends between
/// characters.
std::string headerText(const Diagnostic& warning) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string text;
  for (const char c :
       toString(warning.location) + ": " + warning.message + (warning.hint.empty() ? "" : "; hint: " + warning.hint)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= ' ' && byte < 0x7f && c != '%')
      text += c;
    else
      text.append({'%', digits[byte >> 4U], digits[byte & 15U]});
  }
  if (text.size() <= kMostWarningBytes) return text;
  const auto isWithinCharacter = [&text](std::size_t end) {  // before a byte of UTF-8 that goes on, from 80 to BF
    return text[end - 1] == '%' || text[end - 2] == '%' ||
           (text[end] == '%' && text[end + 1] >= '8' && text[end + 1] <= 'B');
  };
  std::size_t end = kMostWarningBytes;
  while (isWithinCharacter(end)) --end;
  return text.substr(0, end) + "...";
}

/// In headers, which fit every format, and below a table, which people read.
void addWarnings(const std::vector<Diagnostic>& warnings, const ResultOffer& offer, HttpResponse& response) {
  for (std::size_t i = 0; i < std::min(warnings.size(), kMostWarnings); ++i) {
    response.headers.emplace_back(kWarningHeader, headerText(warnings[i]));
    if (offer.format == sparql::ResultFormat::Table) response.body += "\n" + format(warnings[i]) + "\n";
  }
  if (warnings.size() > kMostWarnings)
    response.headers.emplace_back(kWarningHeader,
                                  std::to_string(warnings.size() - kMostWarnings) + " further warnings");
}

}  // namespace

const std::vector<ResultOffer>& offersFor(bool is_graph) {
  using Format = sparql::ResultFormat;
  static const std::vector<ResultOffer> rows{{"application/sparql-results+json", "json", Format::Json},
                                             {"application/json", "json", Format::Json},
                                             {"application/sparql-results+xml", "xml", Format::Xml},
                                             {"application/xml", "xml", Format::Xml},
                                             {"text/csv", "csv", Format::Csv},
                                             {"text/tab-separated-values", "tsv", Format::Tsv},
                                             {"text/plain", "table", Format::Table}};
  static const std::vector<ResultOffer> graphs{{"text/turtle", "turtle", Format::Turtle},
                                               {"application/n-triples", "ntriples", Format::NTriples},
                                               {"text/plain", "text", Format::NTriples}};
  return is_graph ? graphs : rows;
}

FormatRequest formatRequestOf(const HttpRequest& request, const Parameters& parameters) {
  return {request.header("accept"), valueOf(parameters, "format").value_or("")};
}

const ResultOffer& chooseOffer(const FormatRequest& requested, bool is_graph) {
  const std::vector<ResultOffer>& offers = offersFor(is_graph);
  if (!requested.format.empty()) {
    const auto named = std::find_if(offers.begin(), offers.end(),
                                    [&](const ResultOffer& offer) { return offer.name == requested.format; });
    if (named != offers.end()) return *named;
    throw Refusal(400, "format '" + requested.format + "': known here are " +
                           (is_graph ? "turtle, ntriples, text" : "json, xml, csv, tsv, table"));
  }
  std::vector<std::string> types;
  types.reserve(offers.size());
  for (const ResultOffer& offer : offers) types.push_back(offer.media_type);
  if (const auto chosen = negotiate(requested.accept, types)) return offers[*chosen];
  throw Refusal(406, "Accept: " + requested.accept + ": this result can be had as " + listOf(offers));
}

void LimitedBody::add(std::string_view piece) {
  if (text_.size() + piece.size() > max_bytes_)
    throw Error(ErrorKind::BudgetExceeded,
                "the answer is larger than the " + std::to_string(max_bytes_) + " bytes that are allowed");
  text_ += piece;
}

sparql::QueryOptions queryOptions(const RequestLimits& limits) {
  sparql::QueryOptions options;
  if (limits.deadline.count() > 0) options.budget.deadline = limits.deadline;
  options.budget.max_rows = limits.max_rows;
  options.budget.max_memory_bytes = limits.max_memory_bytes;
  options.prefixes = sparql::mapPrefixes();
  return options;
}

sparql::QueryOptions queryOptions(const RequestLimits& limits, const HttpRequest& request) {
  sparql::QueryOptions options = queryOptions(limits);
  options.budget.poll = [&request] {
    if (request.isAbandoned()) throw abandoned();
  };
  return options;
}

HttpResponse answerQuery(const rdf::QuadReader& reader, const std::string& text, const sparql::QueryOptions& options,
                         const std::vector<sparql::Binding>& bindings, const FormatRequest& requested,
                         const RequestLimits& limits) {
  std::vector<std::string> names;
  names.reserve(bindings.size());
  for (const sparql::Binding& binding : bindings) names.push_back(binding.first);
  sparql::PreparedQuery prepared(reader, text, options, names);
  using Form = sparql::ast::QueryForm;
  const bool is_graph = prepared.form() == Form::Construct || prepared.form() == Form::Describe;
  const ResultOffer& offer = chooseOffer(requested, is_graph);
  LimitedBody body(limits.max_answer_bytes);
  const auto writer = makeResultWriter(offer.format, [&body](std::string_view piece) { body.add(piece); });
  std::vector<Diagnostic> warnings = prepared.warnings();
  prepared.run(*writer, bindings);
  for (Diagnostic& note : prepared.notes()) warnings.push_back(std::move(note));
  HttpResponse response = responseWith(body, offer);
  addWarnings(warnings, offer, response);
  return response;
}

HttpResponse answerResult(const sparql::QueryResult& result, const FormatRequest& requested,
                          const RequestLimits& limits) {
  const ResultOffer& offer = chooseOffer(requested, result.kind == sparql::QueryResult::Kind::Graph);
  LimitedBody body(limits.max_answer_bytes);
  const auto writer = makeResultWriter(offer.format, [&body](std::string_view piece) { body.add(piece); });
  replay(result, *writer);
  return responseWith(body, offer);
}

}  // namespace cluxel::serve
