// SPDX-License-Identifier: Apache-2.0
// The newest state of a map file, for callers that ask again and again while others write.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "mapping/map_reader.hpp"

namespace cluxel::mapping {

/// Not thread-safe, except for quads().
class NewestMap {
 public:
  explicit NewestMap(std::filesystem::path file) : file_(std::move(file)) {}

  const std::filesystem::path& file() const { return file_; }
  /// What was read before serves again as long as nobody has committed. Throws as MapReader.
  const MapReader& reader();
  /// A snapshot of its own. Thread-safe.
  rdf::QuadReader quads() const;
  /// Drops what was read: its pages can then be used again by writers.
  void release();
  /// The same, when there is a newer commit; keeps the file open that has the name now.
  void releaseIfOld();

 private:
  bool isKept();
  bool isNewest();

  std::filesystem::path file_;
  std::shared_ptr<rdf::Environment> environment_;  ///< kept open, so that each call finds it open
  std::optional<MapReader> reader_;
  std::shared_ptr<const void> state_;  ///< names the commit that `reader_` reads
};

}  // namespace cluxel::mapping
