// SPDX-License-Identifier: Apache-2.0
// The functions that librdf calls on a query of ours. No exception leaves them: failures go to the world's logger.
#include "cluxel/sparql/redland_query.hpp"

#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>

#include "cluxel/knowledge/redland_storage.hpp"
#include "cluxel/sparql/query_engine.hpp"
#include "cluxel/sparql/result_writer.hpp"
#include "cluxel/sparql/update_engine.hpp"
#include "sparql/redland_answer.hpp"
#include "sparql/redland_query_abi.hpp"

namespace cluxel {
namespace {

using namespace redland_abi;

/// A query's context: a pointer to this.
struct Request {
  std::string text, base;
  bool is_update = false;
  int limit = -1, offset = -1;
};

struct OurResults {
  Results head;
  RedlandAnswer* answer;
};

Request*& requestOf(Query* query) {
  return *static_cast<Request**>(query->context);
}
RedlandAnswer& answerOf(Results* results) {
  return *reinterpret_cast<OurResults*>(results)->answer;
}

template <typename Result, typename Work>
Result guarded(librdf_world* world, Result otherwise, const Work& work) {
  try {
    return work();
  } catch (const std::exception& error) {
    librdf_log_simple(world, 0, LIBRDF_LOG_ERROR, LIBRDF_FROM_QUERY, nullptr, error.what());
    return otherwise;
  }
}

int init(Query* query, const char* name, librdf_uri*, const unsigned char* text, librdf_uri* base) {
  return guarded(query->world, 1, [&] {
    auto request = std::make_unique<Request>();
    request->text = reinterpret_cast<const char*>(text);
    if (base != nullptr) request->base = reinterpret_cast<const char*>(librdf_uri_as_string(base));
    request->is_update = name != nullptr && std::strcmp(name, "cluxel-update") == 0;
    requestOf(query) = request.release();
    return 0;
  });
}

int clone(Query* made, Query* from) {
  return guarded(made->world, 1, [&] {
    requestOf(made) = new Request(*requestOf(from));
    return 0;
  });
}

void terminate(Query* query) {
  delete requestOf(query);
  requestOf(query) = nullptr;
}

QueryResult cut(QueryResult result, const Request& request) {
  ResultTable& table = result.table;
  const std::size_t width = table.variables.size();
  const std::size_t from = std::min(table.row_count, static_cast<std::size_t>(std::max(request.offset, 0)));
  const std::size_t kept = request.limit < 0
                               ? table.row_count - from
                               : std::min(table.row_count - from, static_cast<std::size_t>(request.limit));
  table.cells.erase(table.cells.begin(), table.cells.begin() + static_cast<std::ptrdiff_t>(from * width));
  table.cells.resize(kept * width);
  table.row_count = kept;
  return result;
}

/// The statements of a model of another storage, in a store of their own.
std::shared_ptr<Environment> copied(librdf_model* model) {
  auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  QuadWriter writer(transaction);
  librdf_stream* stream = librdf_model_as_stream(model);
  for (; stream != nullptr && librdf_stream_end(stream) == 0; librdf_stream_next(stream)) {
    librdf_statement* statement = librdf_stream_get_object(stream);
    librdf_node* graph = librdf_stream_get_context2(stream);
    writer.add(Quad{
        redlandTerm(librdf_statement_get_subject(statement)), redlandTerm(librdf_statement_get_predicate(statement)),
        redlandTerm(librdf_statement_get_object(statement)), graph == nullptr ? Term::iri("") : redlandTerm(graph)});
  }
  if (stream != nullptr) librdf_free_stream(stream);
  writer.flush();
  transaction.commit();
  return environment;
}

QueryResult ask(const Request& request, librdf_model* model) {
  QueryOptions options;
  options.base_iri = request.base;
  const auto view = viewRedlandStorage(librdf_model_get_storage(model));
  if (view && view->strict) options.default_graph = DefaultGraph::Unnamed;
  if (view) return cut(evaluateQuery(QuadReader(view->transaction), request.text, options), request);
  const auto environment = copied(model);
  return cut(evaluateQuery(QuadReader(environment->read()), request.text, options), request);
}

QueryResult change(const Request& request, librdf_model* model) {
  const auto view = viewRedlandStorage(librdf_model_get_storage(model));
  if (!view) throw Error(ExitCode::Usage, "SPARQL Update needs a model over the storage \"cluxel\"");
  if (librdf_model_transaction_get_handle(model) != nullptr) {
    throw Error(ExitCode::Usage, "SPARQL Update is a transaction of its own: commit the open one first");
  }
  UpdateOptions options;
  options.query.base_iri = request.base;
  if (view->strict) {
    options.query.default_graph = DefaultGraph::Unnamed;
    options.any_graph_writable = true;
  }
  WriteTransaction transaction = view->environment->write();
  runUpdate(transaction, request.text, options);
  transaction.commit();
  QueryResult done;
  done.kind = QueryResult::Kind::Boolean;
  done.boolean = true;
  return done;
}

Results* execute(Query* query, librdf_model* model) {
  return guarded(query->world, static_cast<Results*>(nullptr), [&] {
    const Request& request = *requestOf(query);
    auto answer =
        std::make_unique<RedlandAnswer>(query->world, request.is_update ? change(request, model) : ask(request, model));
    // librdf frees the results object itself.
    auto* results = static_cast<OurResults*>(std::calloc(1, sizeof(OurResults)));
    if (results == nullptr) throw std::bad_alloc();
    results->head.query = query;
    results->answer = answer.release();
    return &results->head;
  });
}

bool isKind(Results* results, QueryResult::Kind kind) {
  return answerOf(results).result().kind == kind;
}

ResultFormat formatOf(const char* name, const char* mime_type, librdf_uri* uri) {
  for (const char* wanted : {name, mime_type}) {
    if (wanted == nullptr) continue;
    if (const auto format = resultFormatOf(wanted)) return *format;
  }
  const std::string iri = uri == nullptr ? "" : reinterpret_cast<const char*>(librdf_uri_as_string(uri));
  if (iri.find("JSON") != std::string::npos || iri.find("json") != std::string::npos) return ResultFormat::Json;
  return ResultFormat::Xml;
}

Formatter* newFormatter(Results* results, const char* name, const char* mime_type, librdf_uri* uri) {
  if (name != nullptr && !resultFormatOf(name)) return nullptr;
  auto* formatter = static_cast<Formatter*>(std::calloc(1, sizeof(Formatter)));
  if (formatter == nullptr) return nullptr;
  formatter->results = results;
  formatter->own = new ResultFormat(formatOf(name, mime_type, uri));
  return formatter;
}

void freeFormatter(Formatter* formatter) {
  delete static_cast<ResultFormat*>(formatter->own);
  std::free(formatter);
}

int writeFormatted(raptor_iostream* out, Formatter* formatter, Results* results, librdf_uri*) {
  return guarded(results->query->world, 1, [&] {
    const std::string text = writtenResult(answerOf(results).result(), *static_cast<ResultFormat*>(formatter->own));
    return raptor_iostream_counted_string_write(text.data(), text.size(), out);
  });
}

int getBindings(Results* results, const char*** names, librdf_node** values) {
  RedlandAnswer& answer = answerOf(results);
  if (names != nullptr) *names = answer.names();
  for (std::size_t column = 0; values != nullptr && column < answer.columns(); ++column)
    values[column] = answer.value(column);
  return 0;
}

void fillResults(Factory& factory) {
  factory.results_as_stream = [](Results* r) { return answerOf(r).stream(); };
  factory.results_get_count = [](Results* r) { return static_cast<int>(answerOf(r).count()); };
  factory.results_next = [](Results* r) {
    answerOf(r).next();
    return answerOf(r).finished() ? 1 : 0;
  };
  factory.results_finished = [](Results* r) { return answerOf(r).finished() ? 1 : 0; };
  factory.results_get_bindings = getBindings;
  factory.results_get_binding_value = [](Results* r, int column) {
    return answerOf(r).value(static_cast<std::size_t>(column));
  };
  factory.results_get_binding_name = [](Results* r, int column) -> const char* {
    const auto at = static_cast<std::size_t>(column);
    return at < answerOf(r).columns() ? answerOf(r).names()[at] : nullptr;
  };
  factory.results_get_binding_value_by_name = [](Results* r, const char* name) { return answerOf(r).value(name); };
  factory.results_get_bindings_count = [](Results* r) { return static_cast<int>(answerOf(r).columns()); };
  factory.free_results = [](Results* r) { delete &answerOf(r); };
  factory.results_is_bindings = [](Results* r) { return isKind(r, QueryResult::Kind::Solutions) ? 1 : 0; };
  factory.results_is_boolean = [](Results* r) { return isKind(r, QueryResult::Kind::Boolean) ? 1 : 0; };
  factory.results_is_graph = [](Results* r) { return isKind(r, QueryResult::Kind::Graph) ? 1 : 0; };
  factory.results_is_syntax = [](Results*) { return 0; };
  factory.results_get_boolean = [](Results* r) { return answerOf(r).result().boolean ? 1 : 0; };
  factory.new_formatter = newFormatter;
  factory.free_formatter = freeFormatter;
  factory.formatter_write = writeFormatted;
}

void fill(Factory* factory) {
  factory->context_length = sizeof(Request*);
  factory->init = init;
  factory->clone = clone;
  factory->terminate = terminate;
  factory->execute = execute;
  factory->get_limit = [](Query* query) { return requestOf(query)->limit; };
  factory->set_limit = [](Query* query, int limit) { return requestOf(query)->limit = limit, 0; };
  factory->get_offset = [](Query* query) { return requestOf(query)->offset; };
  factory->set_offset = [](Query* query, int offset) { return requestOf(query)->offset = offset, 0; };
  fillResults(*factory);
}

}  // namespace

bool registerRedlandQueries(librdf_world_s* world) {
  if (librdf_version_decimal != kKnownRelease || sizeof(void*) != 8) return false;
  // The library's own factory, where it is there already, must look as expected before one of ours is made.
  const Factory* known = librdf_get_query_factory(world, "sparql", nullptr);
  if (known != nullptr &&
      (known->name == nullptr || std::strcmp(known->name, "sparql") != 0 || known->execute == nullptr)) {
    return false;
  }
  const auto add = [world](const char* name, const char* uri) {
    registerQueryFactory(world, name, reinterpret_cast<const unsigned char*>(uri), fill);
  };
  add("cluxel", "https://w3id.org/cluxel/sparql11-query");
  add("sparql11", nullptr);
  add("cluxel-update", "https://w3id.org/cluxel/sparql11-update");
  return true;
}

}  // namespace cluxel
