// SPDX-License-Identifier: Apache-2.0
// Any bytes as a manifest.
#include "scan/formats/manifest.hpp"
#include "scan_reader_fuzzing.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cluxel;
  using namespace cluxel::scan;
  const std::string_view bytes = fuzz::textOf(data, size);
  fuzz::feed([&] { fuzz::require(!parseManifest(bytes, "m.yaml", "/data").scans.empty()); });
  return 0;
}
