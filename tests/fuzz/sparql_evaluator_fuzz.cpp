// SPDX-License-Identifier: Apache-2.0
// Any bytes as a query over a small store with all kinds of terms: an answer or an Error within its budget, no crash;
// and the same bytes as an update that is dropped afterwards.
#include <cstdint>
#include <string_view>

#include "cluxel/error.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/store/quad_store.hpp"
#include "sparql/query_engine.hpp"
#include "sparql/update_engine.hpp"

namespace {

using namespace cluxel;
using namespace cluxel::rdf;
using namespace cluxel::sparql;

std::shared_ptr<Environment> smallStore() {
  auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  QuadWriter writer(transaction);
  const auto iri = [](const char* name) { return Term::iri(std::string("http://e/") + name); };
  const std::string xsd = "http://www.w3.org/2001/XMLSchema#";
  const Term values[] = {Term::integer(1),
                         Term::integer(-7),
                         Term::literal("2.50", xsd + "decimal"),
                         Term::real(1e300),
                         Term::literal("a"),
                         Term::langLiteral("ä", "de"),
                         Term::boolean(true),
                         Term::literal("x", xsd + "integer"),
                         Term::literal("2024-02-29T12:00:00Z", xsd + "dateTime"),
                         Term::literal("P1M", xsd + "duration"),
                         Term::literal("POINT(1 2)", "http://www.opengis.net/ont/geosparql#wktLiteral"),
                         Term::blank("b"),
                         iri("a")};
  int number = 0;
  for (const Term& value : values) {
    const Term self = iri(number % 2 == 0 ? "a" : "b");
    writer.add(Quad{self, iri("p"), value, Term::iri("")});
    writer.add(Quad{self, iri("q"), value, iri(number % 3 == 0 ? "g" : "h")});
    ++number;
  }
  writer.add(Quad{iri("a"), iri("n"), iri("b"), Term::iri("")});
  writer.add(Quad{iri("b"), iri("n"), iri("a"), Term::iri("")});
  writer.flush();
  transaction.commit();
  return environment;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Longer texts only take longer: what they could break, shorter ones can.
  if (size > 4096) return 0;
  static const std::shared_ptr<Environment> environment = smallStore();
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  QueryOptions options;
  options.budget.deadline = std::chrono::milliseconds(100);
  options.budget.max_work_rows = 50'000;
  options.budget.max_rows = 10'000;
  options.budget.max_memory_bytes = 32 << 20;
  options.base_iri = "http://e/";
  options.seed = 1;
  try {
    const QuadReader reader(environment->read());
    options.services["http://e/service"] = &reader;
    evaluateQuery(reader, text, options);
    whyEmpty(reader, text, options);
    checkQuery(reader, text, options);
  } catch (const Error&) {
  }
  try {
    UpdateOptions update;
    update.query = options;
    update.query.services.clear();  // the reader above is gone
    update.any_graph_writable = true;
    WriteTransaction transaction = environment->write();
    runUpdate(transaction, text, update);
  } catch (const Error&) {
  }
  return 0;
}
