// SPDX-License-Identifier: Apache-2.0
// Changes between visits in Python.
#include <pybind11/stl.h>

#include <array>

#include "gil.hpp"
#include "places.hpp"

namespace cluxel::python {

namespace {

/// The arrays of ChangedPoints.
struct ChangedPointArrays {
  std::vector<std::string> cloud_ids;
  py::array_t<std::uint32_t> cloud, point, change;
  py::array_t<bool> is_gone;
};

struct FoundChanges {
  SiteChanges values;  ///< without points
  std::optional<ChangedPointArrays> points;
};

const char* nameOf(SiteChangeKind kind) {
  constexpr std::array kNames{"vanished", "appeared", "moved"};
  return kNames.at(static_cast<std::size_t>(kind));
}

const char* nameOf(PresenceState state) {
  constexpr std::array kNames{"present", "absent", "not observed"};
  return kNames.at(static_cast<std::size_t>(state));
}

ChangedPointArrays arraysOf(ChangedPoints&& points) {
  return {std::move(points.cloud_ids), arrayOwning<std::uint32_t>(std::move(points.cloud)),
          arrayOwning<std::uint32_t>(std::move(points.point)), arrayOwning<std::uint32_t>(std::move(points.change)),
          arrayOwning<bool>(std::move(points.is_gone))};
}

SiteChanges changesOf(const Map& map, const VisitOptions& options) {
  const ReleasedGil released;
  return map.changes(options);
}

FoundChanges changes(const Map& map, const std::optional<Time>& since, const std::optional<Time>& until,
                     bool with_points, unsigned threads) {
  FoundChanges found{changesOf(map, {since, until, with_points, threads}), std::nullopt};
  if (with_points) found.points = arraysOf(std::exchange(found.values.points, {}));
  return found;
}

void bindThings(py::module_& module) {
  py::class_<ChangedThing>(module, "ChangedThing", "What vanished or appeared together.")
      .def_property_readonly(
          "object", [](const ChangedThing& thing) { return orNone(thing.object); },
          "IRI of the object that most of it belongs to; None when most belongs to none.")
      .def_property_readonly(
          "class_name", [](const ChangedThing& thing) { return orNone(thing.class_name); },
          "Local name of that object's class, such as 'Car'; None without an object.")
      .def_readonly("is_part", &ChangedThing::is_part, "Whether it is a part of that object.")
      .def_readonly("cluxel_count", &ChangedThing::cluxel_count,
                    "Number of cluxels that it is made of, or is a part of.")
      .def_property_readonly(
          "box", [](const ChangedThing& thing) { return boxOf(thing.min, thing.max); },
          "Corners of its box: float64 array of shape (2, 3), smallest and largest x, y, z [m, map frame].");
  py::class_<SiteChange>(module, "SiteChange", "Something that vanished, appeared or moved.")
      .def_property_readonly(
          "kind", [](const SiteChange& change) { return nameOf(change.kind); }, "'vanished', 'appeared' or 'moved'.")
      .def_readonly("thing", &SiteChange::thing,
                    "What vanished or appeared; of 'moved', as it was before: ChangedThing.")
      .def_readonly("now", &SiteChange::now, "Of 'moved', what is there now: ChangedThing; else None.")
      .def_property_readonly(
          "distance_m",
          [](const SiteChange& change) { return change.now ? std::optional(change.distance_m) : std::nullopt; },
          "Of 'moved', between the middles of both boxes [m]; else None.")
      .def("__repr__", [](const SiteChange& change) {
        const std::string& name = change.thing.class_name;
        return std::string("<cluxel.SiteChange ") + nameOf(change.kind) + (name.empty() ? "" : " " + name) + ">";
      });
}

void bindStates(py::module_& module) {
  py::class_<ObjectStates>(module, "ObjectStates", "Whether an object was there before and is there after.")
      .def_readonly("iri", &ObjectStates::iri, "IRI of the object.")
      .def_readonly("number", &ObjectStates::number, "Number of the object, as Object.number.")
      .def_readonly("class_name", &ObjectStates::class_name, "Local name of its class, such as 'Car'.")
      .def_property_readonly(
          "before", [](const ObjectStates& states) { return nameOf(states.before); },
          "'present', 'absent' or 'not observed'.")
      .def_property_readonly(
          "after", [](const ObjectStates& states) { return nameOf(states.after); },
          "'present', 'absent' or 'not observed'.")
      .def_readonly("log_odds_before", &ObjectStates::log_odds_before, "Log-odds that it was there before.")
      .def_readonly("log_odds_after", &ObjectStates::log_odds_after, "Log-odds that it is there after.")
      .def_readonly("coverage_before", &ObjectStates::coverage_before,
                    "Share of its places that scans before hit or saw through.")
      .def_readonly("coverage_after", &ObjectStates::coverage_after, "The same of the scans after.")
      .def_property_readonly(
          "box", [](const ObjectStates& states) { return boxOf(states.min, states.max); },
          "Corners of its box: float64 array of shape (2, 3), smallest and largest x, y, z [m, map frame].")
      .def("__repr__", [](const ObjectStates& states) {
        return "<cluxel.ObjectStates " + states.class_name + ": " + nameOf(states.before) + ", then " +
               nameOf(states.after) + ">";
      });
  py::class_<PartStates>(module, "PartStates", "A part of an object that changed while the object as a whole did not.")
      .def_readonly("part", &PartStates::part, "The part, as ChangedThing.")
      .def_property_readonly(
          "before", [](const PartStates& states) { return nameOf(states.before); }, "'present' or 'absent' before.")
      .def_property_readonly(
          "after", [](const PartStates& states) { return nameOf(states.after); }, "'present' or 'absent' after.");
}

void bindChangedPoints(py::module_& module) {
  py::class_<ChangedPointArrays>(module, "ChangedPoints",
                                 "The measured points of what vanished and appeared while it was there, as arrays of\n"
                                 "the same length N, by cloud and number.")
      .def_readonly("cloud_ids", &ChangedPointArrays::cloud_ids, "Ids of the scans: list of str.")
      .def_readonly("cloud", &ChangedPointArrays::cloud, "uint32 array of shape (N,), place in cloud_ids.")
      .def_readonly("point", &ChangedPointArrays::point,
                    "uint32 array of shape (N,), number of the point in Map.points(cloud).")
      .def_readonly("change", &ChangedPointArrays::change, "uint32 array of shape (N,), place in SiteChanges.changes.")
      .def_readonly("is_gone", &ChangedPointArrays::is_gone,
                    "bool array of shape (N,). True: measured before the thing vanished; False: after it appeared.")
      .def(
          "__len__", [](const ChangedPointArrays& points) { return points.point.size(); }, "Number of points.");
}

}  // namespace

void bindVisits(py::module_& module, py::class_<Map>& map) {
  bindThings(module);
  bindStates(module);
  bindChangedPoints(module);
  py::class_<FoundChanges>(module, "SiteChanges", "What changed at a place between two times.")
      .def_property_readonly(
          "since_s", [](const FoundChanges& found) { return found.values.since_s; },
          "The time that parts before and after: seconds since 1970-01-01 UTC.")
      .def_property_readonly(
          "until_s", [](const FoundChanges& found) { return found.values.until_s; },
          "Later scans do not count: seconds since 1970-01-01 UTC; None: all count.")
      .def_property_readonly(
          "summary", [](const FoundChanges& found) { return found.values.summary; },
          "How many changes there are, and how many objects are there: one line.")
      .def_property_readonly(
          "changes", [](const FoundChanges& found) { return found.values.changes; }, "Changes: list of SiteChange.")
      .def_property_readonly(
          "states", [](const FoundChanges& found) { return found.values.states; },
          "States of all objects but ground, by number: list of ObjectStates.")
      .def_property_readonly(
          "parts", [](const FoundChanges& found) { return found.values.parts; },
          "Parts of objects that changed while the object as a whole did not: list of PartStates.")
      .def_readonly("points", &FoundChanges::points, "ChangedPoints; None without with_points=True.")
      .def("__repr__", [](const FoundChanges& found) { return "<cluxel.SiteChanges " + found.values.summary + ">"; });
  map.def("changes", &changes, py::kw_only(), py::arg("since") = py::none(), py::arg("until") = py::none(),
          py::arg("with_points") = false, py::arg("threads") = 0U,
          "What vanished, appeared and moved between the visits to the place, as SiteChanges.\n\n"
          "since: scans from then on count as after: seconds since 1970, or a str such as '2023-11-15T22:13:20Z' or\n"
          "'2023-11-15'; None: the begin of the last visit (a pause of half an hour ends a visit).\n"
          "until: later scans do not count. with_points: gathers the measured points, too.\n"
          "threads: 0: one per processor; the answer does not depend on it.\n"
          "Raises InvalidArgumentError when a time is none, or when one side of `since` has no scan with a time and a\n"
          "pose.");
}

}  // namespace cluxel::python
