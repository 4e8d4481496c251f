// SPDX-License-Identifier: Apache-2.0
// Binary little-endian PLY, one vertex per point, cloud by cloud. CloudCompare reads fields named scalar_… of type
// float.
#include "tasks/export/cloud_export.hpp"

#include <array>
#include <charconv>
#include <cstring>
#include <string>

#include "mapping/layers/stored_layers.hpp"
#include "mapping/regions/answered_clouds.hpp"
#include "rdf/ontology/ontology.hpp"

namespace cluxel::tasks {

namespace {

constexpr PointColour kGrey{128, 128, 128};

/// "#rrggbb", else grey.
PointColour colourOf(std::string_view text) {
  PointColour colour = kGrey;
  if (text.size() != 7 || text[0] != '#') return colour;
  for (std::size_t i = 0; i < 3; ++i) std::from_chars(text.data() + 1 + 2 * i, text.data() + 3 + 2 * i, colour[i], 16);
  return colour;
}

std::vector<PointColour> coloursOf(const mapping::MapReader& map) {
  const rdf::OntologyView ontology = ontologyViewOf(map.quads());
  std::vector<PointColour> colours;
  mapping::forEachRecord(map.transaction(), [&](const ContentHash& /*id*/, const mapping::ObjectRecord& record) {
    const rdf::OntologyClass* known = ontology.find(record.class_iri);
    colours.push_back(known == nullptr ? kGrey : colourOf(known->color));
  });
  return colours;
}

std::string headerFor(std::uint64_t points) {
  return "ply\nformat binary_little_endian 1.0\ncomment Cluxel: map frame, metres\nelement vertex " +
         std::to_string(points) +
         "\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\nproperty uchar green\n"
         "property uchar blue\nproperty float scalar_primitive\nproperty float scalar_object\nend_header\n";
}

template <typename T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

void writeColouredPly(const mapping::MapReader& map, const ColourOfPoint& colourOfPoint, const ByteSink& out) {
  std::uint64_t total = 0;
  for (const mapping::Cloud& cloud : map.clouds()) total += cloud.point_count;
  out(headerFor(total));
  forEachAnsweredCloud(
      map, [&](const mapping::Cloud& cloud, const scan::ScanPoints& points, const mapping::PointAnswers& answers) {
        std::string bytes;
        for (std::size_t i = 0; i < points.size(); ++i) {
          const Eigen::Vector3d p = scan::toMap(cloud.T_map_sensor, {points.x[i], points.y[i], points.z[i]});
          append(bytes, p.x()), append(bytes, p.y()), append(bytes, p.z());
          const bool has_object = answers.object[i] != mapping::kNoObjectOfPoint;
          append(bytes, colourOfPoint(answers.cluxel[i], answers.object[i]));
          append(bytes, static_cast<float>(answers.label[i]));
          append(bytes, has_object ? static_cast<float>(answers.object[i]) : -1.0F);
        }
        out(bytes);
      });
}

void writeColouredPly(const mapping::MapReader& map, const ByteSink& out) {
  const std::vector<PointColour> colours = coloursOf(map);
  writeColouredPly(
      map,
      [&](std::uint32_t /*cluxel*/, std::uint32_t object) {
        return object == mapping::kNoObjectOfPoint ? kGrey : colours[object];
      },
      out);
}

}  // namespace cluxel::tasks
