// SPDX-License-Identifier: Apache-2.0
// Maps in Python: build, open, query, update, explain, objects and points.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <variant>

#include "gil.hpp"
#include "python_calls.hpp"

namespace cluxel::python {

namespace {

namespace fs = std::filesystem;

using Paths = std::vector<fs::path>;
using PathOrPaths = std::variant<fs::path, Paths>;
using Release = py::call_guard<ReleasedGil>;

using OptionalPaths = std::optional<PathOrPaths>;

Paths listOf(const OptionalPaths& paths) {
  if (!paths) return {};
  if (const auto* one = std::get_if<fs::path>(&*paths)) return {*one};
  return std::get<Paths>(*paths);
}

fs::path pathOf(const std::optional<fs::path>& path) {
  return path.value_or(fs::path());
}

Map build(const PathOrPaths& scans, const fs::path& file, const std::optional<fs::path>& poses,
          const std::optional<fs::path>& model, const OptionalPaths& rules, const OptionalPaths& sparql_rules,
          const OptionalPaths& ontology, const std::optional<fs::path>& home, unsigned threads,
          std::uint64_t batch_points, bool force, bool drop_statements, bool refine_poses, py::object progress,
          py::object note) {
  BuildOptions options;
  options.poses = pathOf(poses);
  options.model = pathOf(model);
  options.rules = listOf(rules);
  options.sparql_rules = listOf(sparql_rules);
  options.ontology = listOf(ontology);
  options.home = pathOf(home);
  options.threads = threads;
  options.batch_points = batch_points;
  options.force = force;
  options.drop_statements = drop_statements;
  options.refine_poses = refine_poses;
  PythonSink sink(std::move(progress), std::move(note));
  const Paths inputs = listOf(scans);
  const ReleasedGil released;
  return Map::build(inputs, file, options, sink);
}

std::chrono::milliseconds deadlineOf(std::optional<double> deadline_s) {
  constexpr double kMax_s = 1e9;  // more is no limit in practice, and would overflow
  if (!deadline_s) return std::chrono::milliseconds(0);
  if (!(*deadline_s > 0))
    throw Error(ErrorKind::InvalidArgument, "deadline_s: write a number of seconds above 0, or None");
  return std::chrono::milliseconds(std::max(1LL, std::llround(std::min(*deadline_s, kMax_s) * 1000)));
}

Answer query(const Map& map, const std::string& text, const py::dict& bindings, std::optional<double> deadline_s,
             std::uint64_t max_rows, std::uint64_t max_memory_bytes, const std::string& source_name,
             bool strict_default_graph) {
  QueryOptions options;
  options.deadline = deadlineOf(deadline_s);
  options.max_rows = max_rows;
  options.max_memory_bytes = max_memory_bytes;
  options.source_name = source_name;
  options.strict_default_graph = strict_default_graph;
  for (const auto& [name, value] : bindings)
    options.bindings.emplace(textOf(name, "the name of a variable"), termOf(value));
  options.poll = SignalPoll();
  const ReleasedGil released;
  return map.query(text, options);
}

py::tuple update(Map& map, const std::string& text, std::optional<double> deadline_s, std::uint64_t max_memory_bytes,
                 const std::string& source_name) {
  UpdateOptions options;
  options.deadline = deadlineOf(deadline_s);
  options.max_memory_bytes = max_memory_bytes;
  options.source_name = source_name;
  options.poll = SignalPoll();
  UpdateCounts counts;
  {
    const ReleasedGil released;
    counts = map.update(text, options);
  }
  return py::module_::import("cluxel").attr("UpdateCounts")(counts.inserted, counts.deleted);
}

/// What explain() and points() take: an object, its number, or a name.
using Named = std::variant<Object, std::size_t, std::string>;

std::string nameOf(const Named& named) {
  if (const auto* object = std::get_if<Object>(&named)) return object->iri;
  if (const auto* number = std::get_if<std::size_t>(&named)) return "#" + std::to_string(*number);
  return std::get<std::string>(named);
}

Explanation explanationOf(const Map& map, const Named& named) {
  const ReleasedGil released;
  return map.explain(nameOf(named));
}

py::dict explain(const Map& map, const Named& named) {
  const Explanation explanation = explanationOf(map, named);
  return py::module_::import("json").attr("loads")(explanation.json);
}

PointCloud pointsOf(const Map& map, const std::variant<Cloud, Named>& owner) {
  const ReleasedGil released;
  if (const auto* cloud = std::get_if<Cloud>(&owner)) return map.points(*cloud);
  return map.points(nameOf(std::get<Named>(owner)));
}

std::vector<Object> objectsOf(const Map& map, const std::optional<std::string>& class_name) {
  return class_name ? map.objects(*class_name) : map.objects();
}

void bindSummary(py::module_& module) {
  namedTuple(module, "UpdateCounts", "inserted deleted", "How many quads an update inserted and deleted.");
  py::class_<MapSummary>(module, "MapSummary", "What a map holds.")
      .def_readonly("is_finished", &MapSummary::is_finished, "False: its build was interrupted.")
      .def_readonly("inputs_hash", &MapSummary::inputs_hash, "Hash of ontology, rules, model and parameters.")
      .def_readonly("clouds", &MapSummary::clouds, "Number of scans.")
      .def_readonly("objects", &MapSummary::objects, "Number of objects.")
      .def_readonly("points", &MapSummary::points, "Number of points.")
      .def_readonly("quads", &MapSummary::quads, "Number of RDF statements.")
      .def_readonly(
          "objects_by_class", &MapSummary::objects_by_class,
          "dict from local name of a class, such as 'Tree', to number of objects; from its IRI when that name is "
          "another class's.")
      .def("__repr__", [](const MapSummary& summary) {
        return "<cluxel.MapSummary " + std::to_string(summary.clouds) + " scans, " + std::to_string(summary.points) +
               " points, " + std::to_string(summary.objects) + " objects, " + std::to_string(summary.quads) + " quads>";
      });
}

constexpr const char* kBuildDoc =
    "Builds the map `file` from scan files, folders and manifests, and opens it.\n\n"
    "An unfinished build of the same inputs goes on; a finished map is replaced only with force=True, and stays as it\n"
    "is when the build fails. Cost: some seconds per million points. Memory: 1 GB, and some 10 bytes a point of a "
    "batch where places are new.\n\n"
    "poses: file of the scans' poses (KITTI 3x4, TUM or 4x4 text); None: beside the scans.\n"
    "model, rules, sparql_rules, ontology: None: the shipped ones. Names may be those of the data folder.\n"
    "home: the data folder; None: CLUXEL_HOME, else that of the installation.\n"
    "threads: 0: one per processor; the map does not depend on it.\n"
    "batch_points: scans are committed in batches of about this many points.\n"
    "drop_statements: with force, drops the operator's statements. refine_poses: registers the scans first.\n"
    "progress: called as progress(stage: str, done: int, total: int). note: called as note(message: str).\n"
    "An exception that they raise, and Ctrl-C, end the build and are passed on; the next build goes on from the last\n"
    "batch that was finished.";

constexpr const char* kQueryDoc =
    "Runs a SPARQL 1.1 query. The answer is whole or an error; nothing is read from a network.\n\n"
    "bindings: values of variables, named without '?': Term, str, bool, int or float.\n"
    "deadline_s: limit of time [s]; None: none. max_rows, max_memory_bytes: limits; 0: none.\n"
    "source_name: names the query in errors. strict_default_graph: True: the default graph is the unnamed graph only,\n"
    "not the union of all graphs but history.\n"
    "Raises FaultyInputError with line and column of a fault, BudgetExceededError at a limit. Ctrl-C ends the query.";

/// Keeps notes until they can be given to Python.
class KeptNotes : public ProgressSink {
 public:
  void note(std::string_view message) override { notes.emplace_back(message); }
  std::vector<std::string> notes;
};

Map openMap(const std::filesystem::path& file, const py::object& note) {
  KeptNotes kept;
  std::optional<Map> map;
  {
    const ReleasedGil released;
    map.emplace(Map::open(file, kept));
  }
  const py::object tell = note.is_none() ? py::module_::import("warnings").attr("warn") : note;
  for (const std::string& message : kept.notes) tell(message);
  return std::move(*map);
}

constexpr const char* kOpenDoc =
    "Opens a map file. Cost: independent of its size.\n\n"
    "note: called as note(message: str), when the map's build is unfinished; None: warnings.warn.";

void bindBuild(py::module_& module) {
  module.def("build", &build, py::arg("scans"), py::arg("file"), py::kw_only(), py::arg("poses") = py::none(),
             py::arg("model") = py::none(), py::arg("rules") = py::none(), py::arg("sparql_rules") = py::none(),
             py::arg("ontology") = py::none(), py::arg("home") = py::none(), py::arg("threads") = 0U,
             py::arg("batch_points") = BuildOptions().batch_points, py::arg("force") = false,
             py::arg("drop_statements") = false, py::arg("refine_poses") = false, py::arg("progress") = py::none(),
             py::arg("note") = py::none(), kBuildDoc);
  module.def("open", &openMap, py::arg("file"), py::kw_only(), py::arg("note") = py::none(), kOpenDoc);
}

}  // namespace

void bindMaps(py::module_& module) {
  bindSummary(module);
  py::class_<Map> map(
      module, "Map",
      "An open map file; cluxel.build and cluxel.open make it. Any number of threads may call its methods.\n"
      "Each call reads the newest state of the file, and other Python threads run meanwhile.");
  map.def_property_readonly("file", &Map::file, "Path of the map file.")
      .def("summary", &Map::summary, Release(), "What the map holds, as MapSummary.")
      .def("query", &query, py::arg("text"), py::kw_only(), py::arg("bindings") = py::dict(),
           py::arg("deadline_s") = py::none(), py::arg("max_rows") = 0U,
           py::arg("max_memory_bytes") = QueryOptions().max_memory_bytes, py::arg("source_name") = "query",
           py::arg("strict_default_graph") = false, kQueryDoc)
      .def("update", &update, py::arg("text"), py::kw_only(), py::arg("deadline_s") = py::none(),
           py::arg("max_memory_bytes") = UpdateOptions().max_memory_bytes, py::arg("source_name") = "update",
           "Runs a SPARQL 1.1 Update on the operator's statements and infers what follows, all of it or nothing.\n"
           "Gives UpdateCounts. LOAD is refused. deadline_s, max_memory_bytes and source_name are as for query().")
      .def("objects", &objectsOf, py::arg("class_name") = py::none(), Release(),
           "The objects that the rules found, sorted by IRI: all, or those of a class, named 'Tree', 'clx:Tree' or by "
           "IRI,\n"
           "as a query for '?object a clx:Tree' finds them. Raises NotFoundError when the ontology has no such class,\n"
           "InvalidArgumentError for one whose things are no objects, such as ways and parts.")
      .def("clouds", &Map::clouds, Release(), "The scans, sorted by id: list of Cloud.")
      .def(
          "points",
          [](const Map& map, const std::variant<Cloud, Named>& owner) { return arraysOf(pointsOf(map, owner)); },
          py::arg("owner"),
          "The points of an object, which is named as for explain(), or of a Cloud, as Points. Those of a cloud come\n"
          "in the order in which they were measured, those of an object scan by scan.")
      .def(
          "explain", &explain, py::arg("name"),
          "Why an object or primitive is what it is, as a dict: measured values, thresholds and margins along the\n"
          "decisions, and why it is nothing else. name: Object, its number, an IRI, 'map:object/…', 'object/…' or\n"
          "'primitive/…', or at least four leading digits of its hash. A former name means the object that it is now.\n"
          "Applies the map's rules again: cost in the size of the map.")
      .def(
          "explain_text", [](const Map& map, const Named& named) { return explanationOf(map, named).text; },
          py::arg("name"), "The same as explain(name), in English prose.")
      .def("__repr__", [](const Map& map) { return "<cluxel.Map " + map.file().string() + ">"; });
  bindChanges(module, map);
  bindTasks(module, map);
  bindWays(module, map);
  bindVisits(module, map);
  bindBuild(module);
}

}  // namespace cluxel::python
