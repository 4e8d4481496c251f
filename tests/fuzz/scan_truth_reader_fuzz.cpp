// SPDX-License-Identifier: Apache-2.0
// Any bytes as a truth file, plain or gzip, and as a table of instances.
#include "scan/truth/truth_parsers.hpp"
#include "scan_reader_fuzzing.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cluxel;
  using namespace cluxel::scan;
  const std::string_view bytes = fuzz::textOf(data, size);
  fuzz::feed([&] {
    const PointTruth truth = parseTruth(bytes, "a.truth", 2);
    fuzz::require(truth.primitive.size() == 2 && truth.object_class.size() == 2 && truth.instance.size() == 2);
  });
  fuzz::feed([&] { parseAmbiguousInstances(bytes, "instances.csv"); });
  return 0;
}
