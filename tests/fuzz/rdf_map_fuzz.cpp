// SPDX-License-Identifier: Apache-2.0
// Any bytes as a map file, or bytes written over a small map: an error or an answer, never a crash.
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <string>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "edited_bytes.hpp"
#include "rdf/file/map_check.hpp"
#include "rdf/store/quad_store.hpp"

namespace {

namespace fs = std::filesystem;
using namespace cluxel;
using namespace cluxel::rdf;

/// A map with terms of all kinds, some pages of quads and a block.
std::string smallMap(const fs::path& file) {
  fs::remove(file);
  {
    const auto environment = Environment::open(file, OpenMode::Create);
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    for (int i = 0; i < 300; ++i) {
      const std::string number = std::to_string(i);
      writer.add({Term::iri("s" + std::to_string(i % 40)), Term::iri("p" + std::to_string(i % 5)), Term::integer(i),
                  Term::iri("")});
      writer.add({Term::iri("s" + number), Term::iri("p"), Term::literal(std::string(static_cast<std::size_t>(i), 'x')),
                  Term::iri("g")});
    }
    writer.flush();
    transaction.putBlock("t", "a", std::string(9000, 'b'));
    transaction.commit();
  }
  return readFile(file);
}

void readAll(const fs::path& file) {
  checkMap(file);
  const auto environment = Environment::open(file, OpenMode::ReadOnly);
  environment->read().block("t", "a");
  const QuadReader reader(environment->read());
  QuadCursor quads = reader.scan({}, QuadOrder::Gspo);
  for (QuadIds quad; quads.next(quad);) reader.termOf(quad.o);
  reader.predicates();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fs::path file = fs::temp_directory_path() / ("cluxel-fuzz-" + std::to_string(::getpid()) + ".clx");
  static const std::string valid = smallMap(file);
  if (size == 0) return 0;
  const std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  writeFile(file, data[0] % 8 == 0 ? std::string(rest) : fuzz::overwritten(valid, rest));
  try {
    readAll(file);
  } catch (const Error&) {
  }
  return 0;
}
