// SPDX-License-Identifier: Apache-2.0
// The inputs of a map beside the scans: ontology, rules, trained model, settings, frame.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/content_hash.hpp"
#include "base/installation/data_home.hpp"
#include "perception/crf/labelling.hpp"
#include "perception/segments/component_tile.hpp"
#include "perception/segments/contact_tile.hpp"
#include "perception/segments/scene_assembly.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rules/language/class_catalogue.hpp"

namespace cluxel::rdf {
struct RdfSource;
}

namespace cluxel::mapping {

/// Increase it with every change of the program that changes stage outputs or facts for the same inputs (perception,
/// reasoning, facts, closure), or the form in which they are stored. Changes and unfinished builds of maps of an older
/// program are then refused instead of mixed.
inline constexpr std::uint32_t kStagesVersion = 21;

/// The name of a file relative to a folder; of a file outside of it the last part.
std::filesystem::path nameWithin(const std::filesystem::path& folder, const std::filesystem::path& file);

/// An authored file as stored in a map.
struct NamedText {
  std::string name;  ///< file name, for messages
  std::string text;
  auto operator<=>(const NamedText&) const = default;
};

/// The name of a SPARQL rule in the map: its file name without the folder.
std::string ruleFileName(const NamedText& rule);

/// Settings of the stages after the features; those of earlier stages are part of the model.
struct MapParams {
  perception::LabellingParams labelling;
  perception::ComponentParams component;
  perception::ContactParams contact;
  perception::RelationParams relation;
};
void describe(MapParams& params, perception::ParameterVisitor& visitor);

struct MapInputs {
  std::string home;                 ///< the data home; not part of the map function
  std::vector<NamedText> ontology;  ///< Turtle
  std::vector<NamedText> rules;     ///< YAML: the first `rule_roots` are loaded, the others are included by them
  std::size_t rule_roots = 0;
  /// CONSTRUCT queries, in the order in which they run; those of files are sorted by name.
  std::vector<NamedText> sparql_rules;
  NamedText model;  ///< JSON
  MapParams params;
  Eigen::Vector3d map_origin = Eigen::Vector3d::Zero();  ///< of the map frame in the outer frame [m]
  std::string crs;                                       ///< of the outer frame, as given; may be empty

  perception::TileGrid tileGrid() const { return perception::TileGrid(map_origin); }
  /// Two maps with the same hash and the same scans are equal.
  ContentHash hash() const;
};

/// "data home …; ontology core.ttl, outdoor.ttl; rules …; SPARQL rules …; model …", for people. Files outside the data
/// home are written with their folders.
std::string describeFiles(const MapInputs& inputs);

/// The input files; empty lists mean the shipped ones.
struct MapInputFiles {
  std::vector<std::filesystem::path> ontology, rules, sparql_rules;
  std::filesystem::path model;  ///< a folder or a file; default models/oakland
};

/// Reads the files through `home`. Throws InputError for a file that is missing, and for faults of an ontology.
MapInputs readMapInputs(const MapInputFiles& files, const DataHome& home);
/// `inputs` with those replaced that `files` names. Rules are read for the ontology of the result.
MapInputs withNamedFiles(MapInputs inputs, const MapInputFiles& files, const DataHome& home);

/// The ontology texts as Turtle sources of graph ontology.
std::vector<rdf::RdfSource> ontologySources(const std::vector<NamedText>& texts);
/// The classes and properties of the texts. Throws InputError with all faults of the texts.
rdf::OntologyView ontologyOf(const std::vector<NamedText>& texts);
/// The classes that rules may name. Throws InputError with all faults of the texts.
rules::ClassCatalogue classCatalogueOf(const std::vector<NamedText>& ontology);

}  // namespace cluxel::mapping
