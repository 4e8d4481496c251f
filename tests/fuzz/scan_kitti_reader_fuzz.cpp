// SPDX-License-Identifier: Apache-2.0
// Any bytes as KITTI points and labels.
#include "scan/formats/kitti_format.hpp"
#include "scan_reader_fuzzing.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cluxel;
  using namespace cluxel::scan;
  const std::string_view bytes = fuzz::textOf(data, size);
  fuzz::feed([&] { fuzz::requireWholeScan(parseKittiPoints(bytes, "a.bin")); });
  fuzz::feed([&] { fuzz::require(parseKittiLabels(bytes, "a.label", size / 4).size() == size / 4); });
  return 0;
}
