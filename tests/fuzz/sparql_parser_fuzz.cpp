// SPDX-License-Identifier: Apache-2.0
// Any bytes as a query, an update and an answer in each format: a value or an InputError, nothing else.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "cluxel/error.hpp"
#include "sparql/support/results_reader_fixture.hpp"
#include "sparql/syntax/parser.hpp"

namespace {

template <typename Read>
void tryTo(Read read) {
  try {
    read();
  } catch (const cluxel::InputError&) {
  }
}

}  // namespace

/// The first byte chooses what the rest is taken for.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  cluxel::sparql::SparqlParseOptions options;
  options.base_iri = "http://example.org/base/";
  options.prefixes = {{"", "http://example.org/"}};
  switch (data[0] % 8) {
    case 0:
    case 1:
    case 2:
      tryTo([&] { cluxel::sparql::parseQuery(text, options); });
      break;
    case 3:
    case 4:
      tryTo([&] { cluxel::sparql::parseUpdate(text, options); });
      break;
    case 5:
      tryTo([&] { cluxel::test::readResults(text, cluxel::sparql::ResultFormat::Xml); });
      break;
    case 6:
      tryTo([&] { cluxel::test::readResults(text, cluxel::sparql::ResultFormat::Json); });
      break;
    default:
      tryTo([&] { cluxel::test::readResults(text, cluxel::sparql::ResultFormat::Tsv); });
      tryTo([&] { cluxel::test::readResults(text, cluxel::sparql::ResultFormat::Csv); });
  }
  return 0;
}
