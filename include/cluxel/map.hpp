// SPDX-License-Identifier: Apache-2.0
// A semantic map: built from scans, opened, queried, updated and explained.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/answer.hpp"
#include "cluxel/change.hpp"
#include "cluxel/export.hpp"
#include "cluxel/ground_ways.hpp"
#include "cluxel/inventory_item.hpp"
#include "cluxel/object.hpp"
#include "cluxel/object_search.hpp"
#include "cluxel/point_cloud.hpp"
#include "cluxel/progress.hpp"
#include "cluxel/term.hpp"
#include "cluxel/visit_changes.hpp"

namespace cluxel {

/// How to build a map. Paths may also be names in the data home: model "oakland" is models/oakland.
struct BuildOptions {
  std::filesystem::path poses;  ///< poses of the scans: KITTI 3x4, TUM or 4x4 text; empty: beside the scans
  std::filesystem::path model;  ///< a trained model; empty: models/oakland
  std::vector<std::filesystem::path> rules;         ///< YAML; empty: rules/outdoor.rules.yaml
  std::vector<std::filesystem::path> sparql_rules;  ///< CONSTRUCT rules; empty: rules/*.rq
  std::vector<std::filesystem::path> ontology;      ///< Turtle; empty: ontology/*.ttl
  /// The folder with ontology, rules, queries, models and labels. Empty: the variable CLUXEL_HOME, else share/cluxel of
  /// the installation of this library, else the checkout it was built in.
  std::filesystem::path home;
  unsigned threads = 0;                     ///< 0: one per processor; the map does not depend on it
  std::uint64_t batch_points = 70'000'000;  ///< scans are committed in batches of about this many points; at least 1
  bool force = false;                       ///< replace a finished map; the operator's statements are kept
  bool drop_statements = false;             ///< with `force`: drop the operator's statements too
  bool refine_poses = false;                ///< register the scans with each other first
};

/// Limits and parameters of a query; 0 means no limit. A negative deadline is refused.
struct QueryOptions {
  std::chrono::milliseconds deadline{0};                   ///< for the run of the query
  std::uint64_t max_rows = 0;                              ///< of the answer
  std::uint64_t max_memory_bytes = 4ULL << 30U;            ///< held by joins, sorts, groups and the answer
  std::map<std::string, Term, std::less<>> bindings = {};  ///< values of variables, named without "?"
  std::string source_name = "query";                       ///< names the query in errors and warnings
  /// The default graph is the union of all graphs but history; true: the unnamed graph only.
  bool strict_default_graph = false;
  /// Called now and then while the query runs, in its thread. What it throws ends the query and reaches the caller.
  std::function<void()> poll = {};
};

/// Limits of an update; 0 means no limit. A negative deadline is refused. An update that exceeds one changes nothing.
struct UpdateOptions {
  std::chrono::milliseconds deadline{0};         ///< for the update and what is inferred from it
  std::uint64_t max_memory_bytes = 4ULL << 30U;  ///< held by the patterns of the update; as much by the inference
  std::string source_name = "update";            ///< names the update in errors
  /// As QueryOptions::poll. What it throws ends the update, which then changes nothing.
  std::function<void()> poll = {};
};

/// How many quads an update inserted and deleted.
struct UpdateCounts {
  std::uint64_t inserted = 0, deleted = 0;
};

/// Why an object or a primitive is what it is.
struct Explanation {
  std::string text;  ///< English prose with line ends
  std::string json;  ///< the same as a JSON object; numbers in the units that stand beside them
};

/// What a map holds.
struct MapSummary {
  bool is_finished = false;  ///< false: its build was interrupted
  std::string inputs_hash;   ///< of ontology, rules, model and parameters
  std::size_t clouds = 0, objects = 0;
  std::uint64_t points = 0, quads = 0;
  std::map<std::string, std::size_t> objects_by_class;  ///< by local name; by IRI if that is another's
};

/// An open map file.
///
/// Thread-safe: any number of threads may call its functions at once. Each call reads one consistent state, the newest
/// commit at its begin, also when another thread or process writes. The const functions never wait for one that writes.
/// summary(), clouds() and explain() wait for each other, and so do calls of points(). All others run in parallel, but
/// tasks and these four wait for layers of the commit that another call is reading: each layer is read once. What
/// explain() reads is kept until the map changes: about 1 KB a cluxel of a map that it explains as a whole. Of what
/// points() reads, 150 MB at most are kept until a call finds another commit, or this object writes. Functions that
/// write wait for each other.
///
/// Callbacks (ProgressSink and `poll`) may call all const functions, also of the map that is being written: they see
/// the last commit. A function that writes a map throws Error (InvalidArgument) in a callback of one that writes the
/// same map, because each would wait for the other, and StoreUnavailable for another map that a thread is writing
/// through the same object.
///
/// All functions throw Error. StoreUnavailable: the file is not a map, or cannot be read or written; FaultyInput (as
/// InputError with file, line and column): scans, rules, ontology, model, query or update; NotFound: no such name;
/// InvalidArgument: an empty path, or options that are wrong or contradict each other; BudgetExceeded: a limit of
/// QueryOptions or UpdateOptions. What a callback throws passes unchanged.
///
/// When another file takes the place of this one (`mv NEW MAP`), the next call reads that one. When the file is moved
/// away, the next call throws StoreUnavailable.
///
/// A map that was moved from may only be destroyed or assigned to.
class CLUXEL_API Map {
 public:
  /// Builds `file` from scan files, folders and manifests, and opens it. An unfinished build of the same inputs goes
  /// on; a finished map is replaced only with `options.force`, and stays as it is when the build fails. Cost: 1 to
  /// 2.5 s of processor time per million points. Memory: about 0.3 GB for two million points, up to 2 GiB for a batch
  /// of the default size.
  static Map build(const std::vector<std::filesystem::path>& scans, const std::filesystem::path& file,
                   const BuildOptions& options = {});
  /// The same; progress and notes go to `sink`.
  static Map build(const std::vector<std::filesystem::path>& scans, const std::filesystem::path& file,
                   const BuildOptions& options, ProgressSink& sink);
  /// Opens a map file. Cost: independent of its size.
  static Map open(const std::filesystem::path& file);
  /// The same; notes to `sink` when the build of the map is unfinished, so that answers are those of some of its scans.
  static Map open(const std::filesystem::path& file, ProgressSink& sink);

  Map(Map&&) noexcept;
  Map& operator=(Map&&) noexcept;
  ~Map();

  const std::filesystem::path& file() const;
  MapSummary summary() const;

  /// Runs a SPARQL 1.1 query. The answer is whole or an error; nothing is read from a network.
  Answer query(std::string_view text, const QueryOptions& options = {}) const;
  /// Runs a SPARQL 1.1 Update on the operator's statements (graph …/graph/operator) and infers what follows, all of it
  /// or nothing. LOAD is refused. Other readers see the state before until it is committed.
  UpdateCounts update(std::string_view text, const UpdateOptions& options = {});

  /// Adds scans (files, folders, manifests) to the map: it is then the map that build() makes from all scans. Scans
  /// that are there with the same pose are passed over. Each batch is one commit; progress and notes go to `sink`.
  MapChanges extend(const std::vector<std::filesystem::path>& scans, const ChangeOptions& options, ProgressSink& sink);
  /// Removes scans, named as in CloudPose; those that were removed before are noted. NotFound for an unknown name;
  /// InvalidArgument when none would be left, or when the file at a path holds another scan of the map now: to find
  /// out, the files at such paths are read. Many scans go in several commits, each of which is the exact map of the
  /// scans that are left then.
  MapChanges retract(const std::vector<std::string>& clouds, const ChangeOptions& options, ProgressSink& sink);
  /// Gives scans other poses, as after a loop closure. Many scans move in several commits, each of which is the exact
  /// map of the poses that the scans have then. No files are read: a path names what was read from it.
  MapChanges repose(const std::vector<CloudPose>& poses, const ChangeOptions& options, ProgressSink& sink);
  /// Merges maps, all in the frame of the first, into the new file `target`, and opens it: the map that build() makes
  /// from all scans. Without `options.force`, a `target` that is the merge of these maps already is left as it is.
  /// InvalidArgument when another map is there and `options.force` is not set; when it has operator statements that the
  /// maps lack and `options.drop_statements` is not set, also when they came while the merge ran; when inputs, map
  /// origins or coordinate systems differ and the options do not say what to do, when `options.use` is none of the
  /// maps, and for `options.dry_run`. StoreUnavailable when `target` is neither a map nor empty. InputError when a scan
  /// has two poses. The work is done in the file `target`.merging, which takes the name at the end; one that a killed
  /// merge left is removed.
  static Map merge(const std::vector<std::filesystem::path>& maps, const std::filesystem::path& target,
                   const MergeOptions& options, ProgressSink& sink);
  /// The same; tells what became of the objects of the maps instead of opening the result. A dry run works in
  /// `target`.merging, too, or in the folder for temporary files when nothing may be written beside `target`, and
  /// removes it.
  static MapChanges mergeInto(const std::vector<std::filesystem::path>& maps, const std::filesystem::path& target,
                              const MergeOptions& options, ProgressSink& sink);

  /// Explains an object or a primitive named by its IRI (also as "map:object/…"), by "object/…" or "primitive/…", by at
  /// least four leading digits of its hash, or an object by its number ("#17"). Applies the map's rules again to the
  /// tiles around it. Reads the whole map only when these tiles do not reproduce the stored decision.
  Explanation explain(const std::string& name) const;

  /// All objects that the rules found, sorted by IRI. Things that SPARQL rules make are answered by query() only.
  std::vector<Object> objects() const;
  /// Those of a class, named "Tree", "clx:Tree" or by IRI, as the query `?object a clx:Tree` finds them: also those
  /// that a SPARQL rule says are of it, though Object::class_iri is another. Numbers are those of objects(). NotFound
  /// when the ontology has no such class; InvalidArgument for a class whose things are no objects, such as ways.
  std::vector<Object> objects(std::string_view class_name) const;

  /// Lists and measures street furniture, trees, parking rows and sidewalks, without what later scans show to be gone.
  /// NotFound for an unknown class; InvalidArgument for one whose things are no objects; InputError for a faulty file
  /// of streets. Cost: the regions of the map in which something is listed.
  Inventory inventory(const InventoryOptions& options = {}) const;
  /// Finds ways over the ground from `start` to `goal`, each moved to the nearest open ground within 2 m, or tells what
  /// closes the way. A further way shares less than 70 % of its cells with the surroundings of those before. NotFound
  /// for an unknown class or object, a place without open ground near it, and when the map holds nothing of the class
  /// `options.near`. Cost: the points of the map, and for each way its cells.
  Routes routes(const Place& start, const Place& goal, const RouteOptions& options = {}) const;
  /// The ground as a grid for the navigation software of a robot, which adds the robot's width. NotFound for an unknown
  /// class. Cost: the points of the map.
  CostMap costMap(const GroundOptions& options = {}) const;
  /// Plans a walk on which a further object of the class is likely seen soon, and tells which the map holds. NotFound
  /// for an unknown class or place, for a start without open ground within 2 m, and for an absent start when no scan
  /// has a pose, or when there are several scans with poses and none has a time; InvalidArgument as for objects(), and
  /// for a file of places that says nothing about the class. Cost: the points of the map, then for each stop the cells
  /// in view of all possible stops.
  SearchTour search(std::string_view class_name, const SearchOptions& options = {}) const;

  /// What vanished, appeared and moved between the visits to the place, and the states of all objects but ground.
  /// InvalidArgument when a time is none, or when one side of `options.since` has no scan with a time and a pose. Cost:
  /// the points and cluxels of the map, region by region, each with the scans that reach it. Memory: that of a region
  /// and of a scan, and of what changed.
  SiteChanges changes(const VisitOptions& options = {}) const;

  /// The scans, sorted by id.
  std::vector<Cloud> clouds() const;
  /// All points of a scan, in the order in which they were measured. Cost: 0.3 us a point, and for the tiles within its
  /// bounds that no call before has left in memory 0.3 us a point of these and 20 ns a point of all scans in them. A
  /// map of less than some 2.4 million points is read as a whole by the second call, and each scan then costs its
  /// points alone. Memory: some 150 MB, and the points.
  PointCloud points(const Cloud& cloud) const;
  /// The points of an object in all scans, scan by scan. Cost: 20 ns a point of the scans whose bounds meet its tiles,
  /// and as for a scan that of its tiles. Memory: as for a scan.
  PointCloud points(const Object& object) const;
  /// The same of an object named as for explain(); a former name means the object that it is now.
  PointCloud points(const std::string& object) const;

 private:
  struct Impl;
  explicit Map(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace cluxel
