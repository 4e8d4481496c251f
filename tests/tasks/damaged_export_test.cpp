// SPDX-License-Identifier: Apache-2.0
// A flipped bit in the blocks of a map: every export gives the bytes of the sound map, or an error.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <random>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/file/lmdb_page.hpp"
#include "tasks/export/map_export.hpp"

namespace cluxel::tasks {

using namespace mapping;
namespace {

namespace fs = std::filesystem;
namespace page = rdf::lmdb_page;

constexpr std::size_t kPage = 4096;

/// A range of bytes of the file.
struct Bytes {
  std::size_t begin = 0, size = 0;
};

/// Of a table that exports of points or footprints read.
bool isBlockKey(std::string_view key) {
  constexpr std::array<std::string_view, 9> kRead{"meta",         "objects",         "scans",
                                                  "scan_points",  "stage_points",    "stage_cluxels",
                                                  "stage_labels", "stage_summaries", "tile_layers"};
  const std::string_view table = key.substr(0, key.find('\0'));
  return table.size() < key.size() && std::find(kRead.begin(), kRead.end(), table) != kRead.end();
}

/// Where the blocks lie: whole pages with their keys, and the pages of long values.
std::vector<Bytes> blockBytes(const std::string& file) {
  std::vector<Bytes> found;
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(file.data());
  for (std::size_t number = 2; number < file.size() / kPage; ++number) {
    const std::uint8_t* at = bytes + number * kPage;
    const page::Header header = page::header(at);
    if (header.number != number || header.flags != page::kLeaf) continue;
    const auto count = page::entryCount(at);
    for (std::size_t i = 0; i < count; ++i) {
      const page::Node node(at, i);
      if (!isBlockKey({reinterpret_cast<const char*>(node.key()), node.keySize()})) break;
      if (i == 0) found.push_back({number * kPage, kPage});
      if (node.flags() == page::kBigData)
        found.push_back({page::load<page::PageNumber>(node.data()) * kPage, node.dataSize()});
    }
  }
  return found;
}

std::string exportOf(const fs::path& file, ExportFormat format) {
  std::string text;
  const MapReader map(file);
  exportMap(
      map, format, [&](std::string_view piece) { text.append(piece); }, ExportFrame::Local);
  return text;
}

class DamagedExport : public testing::Test {
 protected:
  static constexpr std::array kFormats{ExportFormat::Ply, ExportFormat::GeoJson, ExportFormat::Canonical};

  DamagedExport() {
    const SmallCampus campus({.seed = 5, .stops = 2, .size_m = 45, .points_per_stop = 1500});
    const fs::path map = folder_.path() / "sound.clx";
    buildMap(scansOf(campus.files()), shippedInputs(), map, {}, silence());
    bytes_ = readFile(map);
    for (const ExportFormat format : kFormats) sound_.push_back(exportOf(map, format));
  }

  /// The number of exports that end with an error; the others must give the sound map's bytes.
  int errorsAfterFlip(std::size_t at, unsigned bit) {
    std::string damaged = bytes_;
    damaged[at] = static_cast<char>(damaged[at] ^ (1U << bit));
    const fs::path file = folder_.path() / ("flipped" + std::to_string(at) + ".clx");
    std::ofstream(file, std::ios::binary) << damaged;
    int errors = 0;
    for (std::size_t i = 0; i < kFormats.size(); ++i) try {
        EXPECT_TRUE(exportOf(file, kFormats[i]) == sound_[i]) << "byte " << at << ", bit " << bit << ", format " << i;
      } catch (const Error&) {
        ++errors;
      }
    fs::remove(file);
    fs::remove(file.string() + "-lock");
    return errors;
  }

  ScratchFolder folder_;
  std::string bytes_;
  std::vector<std::string> sound_;
};

TEST_F(DamagedExport, IsTheSoundOneOrAnError) {
  const std::vector<Bytes> places = blockBytes(bytes_);
  ASSERT_GT(places.size(), 20U);
  std::mt19937 random(7);
  int errors = 0;
  for (int i = 0; i < 20; ++i) {
    const Bytes place = places[random() % places.size()];
    errors += errorsAfterFlip(place.begin + random() % place.size, static_cast<unsigned>(random() % 8));
  }
  EXPECT_GT(errors, 10) << "most of these bytes are in use";
}

/// No value has changed, so that no checksum fails: the cloud is gone. Pages that are free hold old keys too.
TEST_F(DamagedExport, IsAnErrorWhenTheKeyOfACloudChanged) {
  const std::string key = std::string("scans") + '\0';
  int errors = 0;
  for (std::size_t at = bytes_.find(key); at != std::string::npos; at = bytes_.find(key, at + 1))
    errors += errorsAfterFlip(at + 4, 0);
  EXPECT_GT(errors, 0);
}

}  // namespace
}  // namespace cluxel::tasks
