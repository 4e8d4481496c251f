// SPDX-License-Identifier: Apache-2.0
// Any bytes as a PCD file.
#include "scan/pcd_format.hpp"
#include "scan_reader_fuzzing.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cluxel;
  const std::string_view bytes = fuzz::textOf(data, size);
  fuzz::feed([&] { fuzz::requireWholeScan(parsePcd(bytes, "a.pcd")); });
  return 0;
}
