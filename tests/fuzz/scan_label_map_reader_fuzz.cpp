// SPDX-License-Identifier: Apache-2.0
// Any bytes as a label map.
#include "scan/truth/truth_parsers.hpp"
#include "scan_reader_fuzzing.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cluxel;
  using namespace cluxel::scan;
  const std::string_view bytes = fuzz::textOf(data, size);
  fuzz::feed([&] { fuzz::require(!parseLabelMap(bytes, "labels.yaml").labels.empty()); });
  return 0;
}
