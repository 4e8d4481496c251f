// SPDX-License-Identifier: Apache-2.0
// Any bytes as a map file: an error or an answer, never a crash. Seeds: small maps made by the tests.
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/knowledge/map_check.hpp"
#include "cluxel/knowledge/quad_store.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace fs = std::filesystem;
  const fs::path file = fs::temp_directory_path() / ("cluxel-fuzz-" + std::to_string(::getpid()) + ".clx");
  if (std::FILE* out = std::fopen(file.c_str(), "wb")) {
    if (size > 0) std::fwrite(data, 1, size, out);
    std::fclose(out);
  }
  try {
    cluxel::checkMap(file);
    const auto environment = cluxel::Environment::open(file, cluxel::OpenMode::ReadOnly);
    const cluxel::QuadReader reader(environment->read());
    cluxel::QuadCursor quads = reader.scan({}, cluxel::QuadOrder::Gspo);
    std::size_t length = 0;
    for (cluxel::QuadIds quad; quads.next(quad);) length += reader.termOf(quad.o).text.size();
    reader.predicates();
  } catch (const cluxel::Error&) {
  }
  return 0;
}
