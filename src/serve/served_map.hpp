// SPDX-License-Identifier: Apache-2.0
// One map that is served: its name in paths, snapshots of it, and its objects as a table that is cached per commit.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "cluxel/object.hpp"
#include "mapping/newest_map.hpp"
#include "rdf/ontology/class_names.hpp"
#include "rdf/ontology/ontology.hpp"

namespace cluxel::serve {

/// In place of the name of a commit: the file could not be read.
inline constexpr const char* kUnknownState = "unknown";

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
  const std::filesystem::path& file() const { return keeper_.file(); }
  /// A snapshot of the newest commit, for one request.
  rdf::QuadReader quads() const { return keeper_.quads(); }
  /// Whether the newest commit is one of a build that is not finished.
  bool isUnfinished() const;
  /// Names the newest commit, for the header of answers; kUnknownState when the file cannot be read now. Never throws
  /// for a fault of the file.
  std::string state() const;
  /// Calls `use` with the layers of the newest commit. Callers do not wait for each other, but for layers that another
  /// one is reading: each layer of a commit is read once, and kept as long as the commit is the newest.
  void withReader(const std::function<void(const mapping::MapReader&)>& use);
  /// What is kept with the commit of `snapshot` under the name `what`, made by the first who asks. Others who ask for
  /// it wait for it.
  std::shared_ptr<const void> keptOrMade(const rdf::QuadReader& snapshot, const std::string& what,
                                         const std::function<std::shared_ptr<const void>()>& make);
  /// Lets go of layers that are kept of a commit that is not the newest any more. Requests that read them go on.
  void releaseOldCommit();
  /// Lets go of the layers that are kept, whatever their commit: called before a write.
  void release();

 private:
  void keepNewest();
  std::mutex& makingOf(const std::string& what);

  std::string name_;
  std::mutex keeper_mutex_;    ///< never held while a request computes
  mapping::NewestMap keeper_;  ///< its reader reads nothing; it holds what others of its commit have read
  std::mutex making_mutex_;    ///< guards making_
  std::map<std::string, std::mutex> making_;
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
