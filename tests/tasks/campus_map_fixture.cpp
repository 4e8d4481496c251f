// SPDX-License-Identifier: Apache-2.0
// Builds the map of a generated campus and gathers its truth by instance.
#include "tasks/campus_map_fixture.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>

#include "test_paths.hpp"

namespace cluxel::tasks {

using namespace scan;
using namespace perception;
using namespace simulation;
using namespace rdf;
using namespace sparql;
using namespace rules;
using namespace mapping;

namespace {

std::filesystem::path builtMap(const SmallCampus& campus, const std::filesystem::path& file) {
  MapInputFiles files;
  files.model = "campus";
  buildMap(scansOf(campus.files()), readMapInputs(files, DataHome(test::sourceFolder())), file, {.threads = 2},
           silence());
  return file;
}

std::vector<TruthObject> truthObjects(const SmallCampus& campus) {
  std::map<std::int32_t, TruthObject> by_instance;
  for (const SimulatedScan& stop : campus.scans()) {
    const ScanPoints& points = stop.scan.points;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (stop.truth.instance[i] < 0 || stop.truth.object_class[i] < 0) continue;
      TruthObject& object = by_instance[stop.truth.instance[i]];
      object.class_name = truthClassNames().at(static_cast<std::size_t>(stop.truth.object_class[i]));
      const Eigen::Vector3d p_map = toMap(stop.scan.T_map_sensor, {points.x[i], points.y[i], points.z[i]});
      object.box_map_m.extend(p_map);
      object.center_map_m += (p_map - object.center_map_m) / static_cast<double>(++object.points);
    }
  }
  std::vector<TruthObject> objects;
  for (auto& [instance, object] : by_instance) objects.push_back(std::move(object));
  return objects;
}

std::size_t columnOf(const ResultTable& table, const std::string& name) {
  const auto place = std::find(table.variables.begin(), table.variables.end(), name);
  if (place == table.variables.end()) throw std::out_of_range("the answer has no column " + name);
  return static_cast<std::size_t>(place - table.variables.begin());
}

}  // namespace

const CampusMap& CampusMap::shared() {
  static const CampusMap map;
  return map;
}

CampusMap::CampusMap()
    : campus_({.seed = 3, .stops = 4, .size_m = 60, .points_per_stop = 40'000}),
      file_(folder_.path() / "campus.clx"),
      map_(builtMap(campus_, file_)),
      truth_(truthObjects(campus_)) {}

std::vector<TruthObject> CampusMap::truthOf(const std::string& class_name, std::size_t min_points) const {
  std::vector<TruthObject> found;
  for (const TruthObject& object : truth_)
    if (object.class_name == class_name && object.points >= min_points) found.push_back(object);
  return found;
}

std::map<std::string, Eigen::AlignedBox3d> CampusMap::boxesInRdf() const {
  const QueryResult rows = evaluateQuery(
      map_.quads(),
      "PREFIX clx: <https://w3id.org/cluxel/ontology#> SELECT ?o ?ax ?ay ?az ?bx ?by ?bz { ?o clx:confidence ?c ; "
      "clx:minX ?ax ; clx:minY ?ay ; clx:minZ ?az ; clx:maxX ?bx ; clx:maxY ?by ; clx:maxZ ?bz }");
  std::map<std::string, Eigen::AlignedBox3d> boxes;
  for (std::size_t i = 0; i < rows.table.row_count; ++i) {
    const auto corner = [&](const std::string& end) {
      return Eigen::Vector3d(numberAt(rows.table, i, end + "x"), numberAt(rows.table, i, end + "y"),
                             numberAt(rows.table, i, end + "z"));
    };
    const std::string iri = textAt(rows.table, i, "o");
    boxes[iri.substr(iri.rfind('/') + 1)] = {corner("a"), corner("b")};
  }
  return boxes;
}

ResultTable CampusMap::answer(const std::string& name, const std::vector<std::string>& parameters) const {
  const Question question = readQuestion(test::sourceFolder() / "queries" / (name + ".rq"));
  const std::vector<Binding> bindings = bindingsFor(question, parameters);
  std::vector<std::string> names;
  for (const Binding& binding : bindings) names.push_back(binding.first);
  return PreparedQuery(map_.quads(), question.text, {}, names).evaluate(bindings).table;
}

double numberAt(const ResultTable& table, std::size_t row, const std::string& column) {
  double value = std::numeric_limits<double>::quiet_NaN();
  const Term* term = table.at(row, columnOf(table, column));
  if (term == nullptr || term->kind != TermKind::Literal) return value;
  const char* end = term->text.data() + term->text.size();
  const auto [stop, fault] = std::from_chars(term->text.data(), end, value);
  return fault == std::errc() && stop == end ? value : std::numeric_limits<double>::quiet_NaN();
}

std::string textAt(const ResultTable& table, std::size_t row, const std::string& column) {
  const Term* term = table.at(row, columnOf(table, column));
  return term == nullptr ? "" : term->text;
}

std::string placeOfAStop(const MapReader& map) {
  const Eigen::Vector3d place = map.clouds().front().T_map_sensor.translation();
  return std::to_string(place.x()) + "," + std::to_string(place.y());
}

}  // namespace cluxel::tasks
