// SPDX-License-Identifier: Apache-2.0
// One map that is served: its name in paths, snapshots of it, and its objects as a table that is cached per commit.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "cluxel/object.hpp"
#include "mapping/newest_map.hpp"
#include "rdf/ontology/class_names.hpp"
#include "rdf/ontology/ontology.hpp"

namespace cluxel::serve {

/// The objects of one commit.
struct ObjectTable {
  std::vector<Object> objects;  ///< sorted by IRI
  rdf::OntologyView ontology;
  rdf::ClassNames class_names;
};

/// Thread-safe.
class ServedMap {
 public:
  /// Throws Error (StoreUnavailable) when the file is not a readable map.
  ServedMap(std::string name, const std::filesystem::path& file);

  const std::string& name() const { return name_; }
  const std::filesystem::path& file() const { return map_.file(); }
  /// A snapshot of the newest commit, for one request.
  rdf::QuadReader quads() const { return map_.quads(); }
  /// Whether the newest commit is one of a build that is not finished.
  bool isUnfinished() const;
  /// Calls `use` with the layers of the newest commit; one caller at a time.
  void withReader(const std::function<void(const mapping::MapReader&)>& use);
  /// Drops what withReader() keeps of a commit that is not the newest any more.
  void releaseOldCommit();
  /// Drops what withReader() keeps, whatever its commit: called before a write.
  void release();

 private:
  std::string name_;
  std::mutex mutex_;
  mapping::NewestMap map_;
};

/// The objects of the snapshot, read once for each commit.
std::shared_ptr<const ObjectTable> objectsOf(const rdf::QuadReader& snapshot);

/// "campus" of "maps/campus.clx", and name and file of "name=maps/campus.clx". Throws Error (InvalidArgument) for a
/// name that is empty or given twice.
struct MapArgument {
  std::string name;
  std::filesystem::path file;
};
std::vector<MapArgument> mapArgumentsOf(const std::vector<std::string>& texts);

}  // namespace cluxel::serve
