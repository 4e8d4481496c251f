// SPDX-License-Identifier: Apache-2.0
// Changes of maps in Python: extend, retract, repose, merge, and what they did to the objects.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <map>
#include <variant>

#include "gil.hpp"
#include "python_calls.hpp"

namespace cluxel::python {

namespace {

using ChangePaths = std::variant<std::filesystem::path, std::vector<std::filesystem::path>>;
using Matrix = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::vector<std::filesystem::path> listOfChanged(const ChangePaths& paths) {
  if (const auto* one = std::get_if<std::filesystem::path>(&paths)) return {*one};
  return std::get<std::vector<std::filesystem::path>>(paths);
}

const char* nameOf(ChangeKind kind) {
  switch (kind) {
    case ChangeKind::Added:
      return "added";
    case ChangeKind::Gone:
      return "gone";
    case ChangeKind::Changed:
      return "changed";
    case ChangeKind::Split:
      return "split";
    case ChangeKind::Joined:
      return "joined";
    case ChangeKind::Redecided:
      break;
  }
  return "redecided";
}

/// Runs a change without the GIL.
template <typename Change>
auto changed(py::object progress, py::object note, const Change& change) {
  PythonSink sink(std::move(progress), std::move(note));
  const ReleasedGil released;
  return change(sink);
}

MapChanges extend(Map& map, const ChangePaths& scans, const std::optional<std::filesystem::path>& poses,
                  unsigned threads, std::optional<std::uint64_t> batch_points, bool dry_run, py::object progress,
                  py::object note) {
  const ChangeOptions options{poses.value_or(std::filesystem::path()), threads, batch_points, dry_run};
  return changed(std::move(progress), std::move(note),
                 [&](ProgressSink& sink) { return map.extend(listOfChanged(scans), options, sink); });
}

MapChanges retract(Map& map, const std::vector<std::string>& clouds, unsigned threads,
                   std::optional<std::uint64_t> batch_points, bool dry_run, py::object progress, py::object note) {
  const ChangeOptions options{{}, threads, batch_points, dry_run};
  return changed(std::move(progress), std::move(note),
                 [&](ProgressSink& sink) { return map.retract(clouds, options, sink); });
}

/// `what` says whose it is.
std::array<double, 16> rowByRow(const Matrix& matrix, const std::string& what) {
  if (matrix.ndim() != 2 || matrix.shape(0) != 4 || matrix.shape(1) != 4)
    throw Error(ErrorKind::InvalidArgument, what + " has another shape than (4, 4)");
  std::array<double, 16> numbers{};
  std::copy_n(matrix.data(), numbers.size(), numbers.begin());
  return numbers;
}

MapChanges repose(Map& map, const std::map<std::string, Matrix>& poses, unsigned threads,
                  std::optional<std::uint64_t> batch_points, bool dry_run, py::object progress, py::object note) {
  std::vector<CloudPose> given;
  for (const auto& [cloud, matrix] : poses) {
    given.push_back({cloud, rowByRow(matrix, "the pose for cloud " + cloud)});
  }
  const ChangeOptions options{{}, threads, batch_points, dry_run};
  return changed(std::move(progress), std::move(note),
                 [&](ProgressSink& sink) { return map.repose(given, options, sink); });
}

using OptionalMatrix = std::optional<Matrix>;

MergeOptions mergeOptionsOf(const OptionalMatrix& T_first_second, const std::optional<std::filesystem::path>& use,
                            bool force, bool drop_statements, bool dry_run, unsigned threads,
                            std::optional<std::uint64_t> batch_points) {
  MergeOptions options;
  options.threads = threads;
  options.batch_points = batch_points;
  options.use = use.value_or(std::filesystem::path());
  options.force = force;
  options.drop_statements = drop_statements;
  options.dry_run = dry_run;
  if (T_first_second) options.T_first_second = rowByRow(*T_first_second, "T_first_second");
  return options;
}

Map merge(const std::vector<std::filesystem::path>& maps, const std::filesystem::path& target,
          const OptionalMatrix& T_first_second, const std::optional<std::filesystem::path>& use, bool force,
          bool drop_statements, unsigned threads, std::optional<std::uint64_t> batch_points, py::object progress,
          py::object note) {
  const MergeOptions options =
      mergeOptionsOf(T_first_second, use, force, drop_statements, false, threads, batch_points);
  return changed(std::move(progress), std::move(note),
                 [&](ProgressSink& sink) { return Map::merge(maps, target, options, sink); });
}

MapChanges mergeInto(const std::vector<std::filesystem::path>& maps, const std::filesystem::path& target,
                     const OptionalMatrix& T_first_second, const std::optional<std::filesystem::path>& use, bool force,
                     bool drop_statements, bool dry_run, unsigned threads, std::optional<std::uint64_t> batch_points,
                     py::object progress, py::object note) {
  const MergeOptions options =
      mergeOptionsOf(T_first_second, use, force, drop_statements, dry_run, threads, batch_points);
  return changed(std::move(progress), std::move(note),
                 [&](ProgressSink& sink) { return Map::mergeInto(maps, target, options, sink); });
}

void bindValues(py::module_& module) {
  py::class_<ObjectChange>(module, "ObjectChange", "An object that a change added, removed or altered.")
      .def_property_readonly(
          "kind", [](const ObjectChange& change) { return nameOf(change.kind); },
          "'added', 'gone', 'changed', 'split', 'joined' or 'redecided': the same members and class, and other parts,\n"
          "another rule or another confidence.")
      .def_readonly("iri", &ObjectChange::iri, "Its IRI; of a gone object the one that it had.")
      .def_readonly("class_name", &ObjectChange::class_name, "Local name of its class, such as 'Tree'.")
      .def_readonly("derived_from", &ObjectChange::derived_from, "IRIs of the objects before the change.");
  py::class_<MapChanges>(module, "MapChanges",
                         "What a change did. Object B continues object A when they share at least half of the cluxels\n"
                         "of the smaller one.")
      .def_readonly("scans_added", &MapChanges::scans_added, "Number of scans.")
      .def_readonly("scans_already_there", &MapChanges::scans_already_there, "Number of scans that were passed over.")
      .def_readonly("scans_removed", &MapChanges::scans_removed, "Number of scans.")
      .def_readonly("scans_moved", &MapChanges::scans_moved, "Number of scans.")
      .def_readonly("tiles_changed", &MapChanges::tiles_changed, "Number of tiles of 16 m that were computed anew.")
      .def_readonly("objects_unchanged", &MapChanges::objects_unchanged, "Number of objects.")
      .def_readonly("objects", &MapChanges::objects, "list of ObjectChange, by kind and IRI.");
}

}  // namespace

void bindChanges(py::module_& module, py::class_<Map>& map) {
  bindValues(module);
  map.def("extend", &extend, py::arg("scans"), py::kw_only(), py::arg("poses") = py::none(), py::arg("threads") = 0U,
          py::arg("batch_points") = py::none(), py::arg("dry_run") = false, py::arg("progress") = py::none(),
          py::arg("note") = py::none(),
          "Adds scans: the map is then the one that build() makes from all scans. Scans that are there with the same\n"
          "pose are passed over. dry_run: tells what would change, and writes nothing. Gives MapChanges.");
  map.def("retract", &retract, py::arg("clouds"), py::kw_only(), py::arg("threads") = 0U,
          py::arg("batch_points") = py::none(), py::arg("dry_run") = false, py::arg("progress") = py::none(),
          py::arg("note") = py::none(),
          "Removes scans, named by id (four digits or more), source path or file name, batch by batch. Gives\n"
          "MapChanges.");
  map.def("repose", &repose, py::arg("poses"), py::kw_only(), py::arg("threads") = 0U,
          py::arg("batch_points") = py::none(), py::arg("dry_run") = false, py::arg("progress") = py::none(),
          py::arg("note") = py::none(),
          "Gives scans other poses, batch by batch. poses: dict from cloud, named as in retract(), to the pose of the\n"
          "sensor in the map, an array of shape (4, 4) [m]. Gives MapChanges.");
  module.def(
      "merge", &merge, py::arg("maps"), py::arg("target"), py::kw_only(), py::arg("T_first_second") = py::none(),
      py::arg("use") = py::none(), py::arg("force") = false, py::arg("drop_statements") = false,
      py::arg("threads") = 0U, py::arg("batch_points") = py::none(), py::arg("progress") = py::none(),
      py::arg("note") = py::none(),
      "Merges maps, all in the frame of the first, into the new file `target`, and opens it.\n\n"
      "T_first_second: for two maps, takes points of the second to the frame of the first: an array of shape\n"
      "(4, 4), a rigid motion [m]. Given, also as the identity, it allows other frames.\n"
      "use: the map of them whose ontology, rules and model are used; None: they must agree.\n"
      "force: replaces another map, or an empty file, that is there. drop_statements: with force, also one that\n"
      "has operator statements which the maps lack; they are lost.");
  module.def(
      "merge_into", &mergeInto, py::arg("maps"), py::arg("target"), py::kw_only(),
      py::arg("T_first_second") = py::none(), py::arg("use") = py::none(), py::arg("force") = false,
      py::arg("drop_statements") = false, py::arg("dry_run") = false, py::arg("threads") = 0U,
      py::arg("batch_points") = py::none(), py::arg("progress") = py::none(), py::arg("note") = py::none(),
      "The same as merge(); tells what became of the objects of the maps, as MapChanges. dry_run: tells what it\n"
      "would make, and writes no target.");
}

}  // namespace cluxel::python
