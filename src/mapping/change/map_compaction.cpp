// SPDX-License-Identifier: Apache-2.0
// Counts what a rewrite would free, and rewrites the map beside itself.
#include "mapping/change/map_compaction.hpp"

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/build/build_lock.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/file/layer_sizes.hpp"
#include "rdf/file/map_replacement.hpp"

namespace cluxel::mapping {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kLargestShare = 20;  // a twentieth
constexpr std::uint64_t kSmallestGain = std::uint64_t{1} << 20U;

bool isSparse(const fs::path& map) {
  const auto environment = rdf::Environment::open(map, rdf::OpenMode::ReadOnly);
  const auto layers = rdf::layerSizes(environment->read());
  const std::uint64_t gain = rdf::freeableBytes(layers);
  std::uint64_t all = 0;
  for (const rdf::LayerSize& layer : layers) all += layer.file_bytes;
  return gain > kSmallestGain && gain * kLargestShare > all;
}

}  // namespace

/// Locks out other writers: what they commit while the file is replaced would be lost.
void compactMap(const fs::path& map) {
  const fs::path file = withoutLinks(map), target = file.string() + ".compact";
  const BuildLock no_build(file);
  const auto environment = rdf::Environment::open(file, rdf::OpenMode::ReadWrite);
  const rdf::WriteTransaction no_other_writer = environment->write();
  std::error_code ignored;
  fs::remove(target, ignored);  // left by a killed run
  environment->compactTo(target);
  try {
    rdf::replaceMapFile(target, file);
  } catch (...) {
    fs::remove(target, ignored);
    throw;
  }
}

void compactIfSparse(const fs::path& map, ProgressSink& sink) {
  try {
    if (isSparse(map)) compactMap(map);
  } catch (const Error& error) {
    sink.note(map.string() +
              ": is whole, but takes more space than it needs, because it could not be rewritten: " + error.what());
  }
}

}  // namespace cluxel::mapping
