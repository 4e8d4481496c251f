// SPDX-License-Identifier: Apache-2.0
// Any bytes as each of the text formats of scans.
#include "scan/formats/text_formats.hpp"
#include "scan_reader_fuzzing.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cluxel;
  using namespace cluxel::scan;
  const std::string_view bytes = fuzz::textOf(data, size);
  columnsOfFirstLine(bytes);
  fuzz::feed([&] { fuzz::requireWholeScan(parseXyzText(bytes, "a.xyz")); });
  fuzz::feed([&] { fuzz::requireWholeScan(parseLabelledText(bytes, "a.txt")); });
  fuzz::feed([&] { fuzz::requireWholeScan(parseFreiburgPoints(bytes, "a.dat")); });
  fuzz::feed([&] { fuzz::require(parseLabelLines(bytes, "labels.dat", 2).size() == 2); });
  return 0;
}
