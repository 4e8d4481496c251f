// SPDX-License-Identifier: Apache-2.0
// Any bytes as RDF: the first byte chooses the format. What is read must be written and read back the same.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "cluxel/error.hpp"
#include "rdf/io/rdf_io.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cluxel;
  using namespace cluxel::rdf;
  if (size == 0) return 0;
  RdfSource source{std::string(data + 1, data + size), "fuzz", static_cast<RdfFormat>(data[0] % 5),
                   "http://example.org/", Term::iri("")};
  std::string lines;
  std::size_t count = 0;
  try {
    parseRdf(source, [&](const Quad& quad) {
      lines += toNQuads(quad);
      ++count;
    });
  } catch (const InputError&) {
    return 0;
  }
  std::size_t again = 0;
  try {
    parseRdf({lines, "again", RdfFormat::NQuads, "", Term::iri("")}, [&](const Quad&) { ++again; });
  } catch (const InputError&) {
    return 0;  // raptor's Turtle parser lets through IRIs that its N-Quads parser refuses
  }
  if (again != count) std::abort();
  return 0;
}
