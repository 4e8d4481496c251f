// SPDX-License-Identifier: Apache-2.0
// What a map is a function of, beside the scans: ontology, rules, trained model, settings, frame.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "cluxel/base/content_hash.hpp"
#include "cluxel/base/data_home.hpp"
#include "cluxel/perception/component_tile.hpp"
#include "cluxel/perception/contact_tile.hpp"
#include "cluxel/perception/labelling.hpp"
#include "cluxel/perception/scene_assembly.hpp"

namespace cluxel {

/// To be raised by every change of the program that gives other stage outputs or facts for the same inputs (perception,
/// reasoning, facts, closure; not storage): an unfinished build of the program before it is then refused, not mixed
/// with.
inline constexpr std::uint32_t kStagesVersion = 3;

/// An authored file as it went into a map.
struct NamedText {
  std::string name;  ///< file name, for messages
  std::string text;
  auto operator<=>(const NamedText&) const = default;
};

/// How a SPARQL rule is named in the map: its file's name without the folder.
std::string ruleFileName(const NamedText& rule);

/// Settings of the stages behind the features; those before are part of the model.
struct MapParams {
  LabellingParams labelling;
  ComponentParams component;
  ContactParams contact;
  RelationParams relation;
};
void describe(MapParams& params, ParameterVisitor& visitor);

struct MapInputs {
  std::vector<NamedText> ontology;  ///< Turtle
  std::vector<NamedText> rules;     ///< YAML: the first `rule_roots` are loaded, the others are included by them
  std::size_t rule_roots = 0;
  std::vector<NamedText> sparql_rules;  ///< CONSTRUCT queries, in the order in which they run
  NamedText model;                      ///< JSON
  MapParams params;
  Eigen::Vector3d map_origin = Eigen::Vector3d::Zero();  ///< of the map frame in the outer frame [m]
  std::string crs;                                       ///< of the outer frame, as given; may be empty

  /// Two maps with the same hash and the same scans are the same map.
  ContentHash hash() const;
};

/// Which files to take; empty means the shipped ones.
struct MapInputFiles {
  std::vector<std::filesystem::path> ontology, rules, sparql_rules;
  std::filesystem::path model;  ///< a folder or a file; default models/oakland
};

/// Reads the files through `home`. Throws InputError for a file that is missing.
MapInputs readMapInputs(const MapInputFiles& files, const DataHome& home);

}  // namespace cluxel
