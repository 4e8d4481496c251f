// SPDX-License-Identifier: Apache-2.0
// Any bytes as a model file, or edits of a small model: a model or an InputError; a model that is read is written and
// read again the same.
#include "edited_bytes.hpp"
#include "perception/crf/label_model.hpp"
#include "scan_reader_fuzzing.hpp"

namespace {

using namespace cluxel;
using namespace cluxel::scan;
using namespace cluxel::perception;

LabelModel smallModel() {
  LabelModel model;
  model.name = "small";
  model.layout = featureLayout(model.perception.features);
  model.unary.columns = static_cast<std::uint32_t>(model.layout.columns.size());
  ObliviousTree tree;
  tree.splits = {{0, 0.5F}, {1, 1.5F}};
  tree.leaves.resize(4);
  model.unary.trees = {tree, tree};
  const std::size_t columns = model.layout.edge_columns.size();
  model.pairs.knots.assign(columns, HatKnots{0, 1, 2});
  model.pairs.weights.resize(1 + kHats * columns);
  return model;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string valid = modelText(smallModel());
  if (size == 0) return 0;
  const std::string_view rest = fuzz::textOf(data + 1, size - 1);
  const std::string text = data[0] % 4 == 0 ? std::string(rest) : fuzz::edited(valid, rest);
  fuzz::feed([&] {
    const std::string written = modelText(parseModel(text, "model.json"));
    fuzz::require(modelText(parseModel(written, "again.json")) == written);
  });
  return 0;
}
