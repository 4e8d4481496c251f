// SPDX-License-Identifier: Apache-2.0
// Reads registers and streets: CSV and GeoJSON.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <utility>

#include "base/ascii.hpp"
#include "base/file_bytes.hpp"
#include "base/utf8.hpp"
#include "cluxel/error.hpp"
#include "rdf/vocabulary.hpp"
#include "tasks/export/proj_geo_reference.hpp"
#include "tasks/finite_number.hpp"
#include "tasks/inventory/register.hpp"
#include "tasks/named_class.hpp"

namespace cluxel::tasks {

namespace {

using PlaceReader = std::function<Eigen::Vector2d(double, double)>;

/// The place in the map frame whose longitude and latitude are given, by Newton's method on the projection.
Eigen::Vector2d mapPlaceOf(const GeoReference& earth, const Eigen::Vector2d& degrees) {
  constexpr double step_m = 1;
  constexpr int rounds = 6;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  for (int i = 0; i < rounds; ++i) {
    const Eigen::Vector2d here = earth.longitudeLatitude(place);
    Eigen::Matrix2d slope;
    slope.col(0) = (earth.longitudeLatitude(place + Eigen::Vector2d(step_m, 0)) - here) / step_m;
    slope.col(1) = (earth.longitudeLatitude(place + Eigen::Vector2d(0, step_m)) - here) / step_m;
    place += slope.inverse() * (degrees - here);
  }
  return place;
}

/// Of metres in the map frame.
Eigen::Vector2d placeInMap(double x, double y) {
  return {x, y};
}

/// Of longitude and latitude. `in_metres`: what to write for metres of the map frame.
PlaceReader degreesReader(const std::filesystem::path& file, const mapping::MapInputs& inputs,
                          const std::string& in_metres) {
  if (inputs.crs.empty())
    throw InputError({.file = file.string()}, "it has longitude and latitude, but the map has no coordinate system",
                     in_metres);
  const auto earth = std::make_shared<GeoReference>(inputs.crs, inputs.map_origin);
  static_cast<void>(earth->longitudeLatitude(Eigen::Vector2d::Zero()));
  return [earth, file, in_metres](double lon, double lat) {
    if (std::abs(lon) > 180 || std::abs(lat) > 90)
      throw InputError({.file = file.string()},
                       nlohmann::json(lon).dump() + ", " + nlohmann::json(lat).dump() + " is no longitude and latitude",
                       "write WGS 84 degrees; " + in_metres);
    try {
      return mapPlaceOf(*earth, {lon, lat});
    } catch (const Error&) {  // the map's place is right
      throw InputError({.file = file.string()},
                       nlohmann::json(lon).dump() + ", " + nlohmann::json(lat).dump() +
                           " lies where the map's coordinate system is not defined",
                       "write longitude and latitude (WGS 84) near the map");
    }
  };
}

std::vector<std::string> csvFields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && is_quoted && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += line[++i];
    } else if (c == '"') {
      is_quoted = !is_quoted;
    } else if (c == ',' && !is_quoted) {
      fields.emplace_back();
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  return fields;
}

/// The columns of a CSV by name; npos when there is none.
struct CsvHeader {
  std::vector<std::string> names;
  std::size_t of(const char* name) const {
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == name) return i;
    return std::string::npos;
  }
};

/// Takes what was written for the class and the height of an entry, and collects faults.
class EntryReader {
 public:
  EntryReader(const rdf::OntologyView& ontology, const mapping::MapInputs& inputs)
      : ontology_(ontology), inputs_(inputs) {}

  /// `place`: where faults are, with what stands in front of their messages.
  void read(RegisterEntry& entry, const std::string& kind, std::string_view height, const Diagnostic& place) {
    try {
      entry.class_iri = classNamed(ontology_, kind, [&] { return namespacesOf(inputs_); });
    } catch (const Error& error) {
      addFault(place, error.what(), "");
    }
    if (trimmed(height).empty()) return;
    entry.height_m = finiteNumber(trimmed(height));
    if (!entry.height_m)
      addFault(place, "the height '" + std::string(height) + "' is no number", "write metres with a point, or nothing");
  }

  void addFault(Diagnostic place, const std::string& what, const std::string& hint) {
    place.message += what;
    place.hint = hint;
    faults_.push_back(std::move(place));
  }

  void throwFaults() {
    if (!faults_.empty()) throw InputError(std::move(faults_));
  }

 private:
  const rdf::OntologyView& ontology_;
  const mapping::MapInputs& inputs_;
  std::vector<Diagnostic> faults_;
};

std::vector<RegisterEntry> readCsvRegister(const std::filesystem::path& file, const mapping::MapInputs& inputs,
                                           EntryReader reader) {
  const std::string text = readFile(file);
  std::istringstream lines{std::string(withoutByteOrderMark(text))};
  std::string line;
  std::getline(lines, line);
  const CsvHeader header{csvFields(line)};
  const std::size_t kind = std::min(header.of("class"), header.of("kind")), id = header.of("id"),
                    height = header.of("height");
  const bool is_degrees = header.of("x") == std::string::npos;
  const std::size_t x = header.of(is_degrees ? "lon" : "x"), y = header.of(is_degrees ? "lat" : "y");
  if (kind == std::string::npos || x == std::string::npos || y == std::string::npos)
    throw InputError({.file = file.string(), .line = 1, .column = 1}, "the header lacks columns",
                     "write class,x,y (metres of the map frame) or class,lon,lat; id and height may follow");
  const PlaceReader place =
      is_degrees ? degreesReader(file, inputs, "x and y instead are metres of the map frame") : placeInMap;
  std::vector<RegisterEntry> entries;
  for (std::size_t number = 2; std::getline(lines, line); ++number) {
    const std::vector<std::string> fields = csvFields(line);
    if (fields.size() == 1 && fields[0].empty()) continue;
    const auto field = [&](std::size_t column) { return column < fields.size() ? fields[column] : std::string(); };
    const Diagnostic here{Severity::Error, {file.string(), number, 1, std::nullopt}, "", "", line};
    const auto px = finiteNumber(trimmed(field(x))), py = finiteNumber(trimmed(field(y)));
    if (!px || !py || trimmed(field(kind)).empty()) {
      reader.addFault(here, "the line has no class or no place", "write numbers with a point");
      continue;
    }
    RegisterEntry& entry = entries.emplace_back();
    entry.id = id < fields.size() ? fields[id] : std::to_string(number - 1);
    entry.at = place(*px, *py);
    reader.read(entry, field(kind), field(height), here);
  }
  reader.throwFaults();
  return entries;
}

nlohmann::json geoJsonOf(const std::filesystem::path& file) {
  nlohmann::json json = nlohmann::json::parse(readFile(file), nullptr, false);
  if (json.is_discarded() || !json.is_object() || !json.contains("features") || !json["features"].is_array())
    throw InputError({.file = file.string()}, "it is no GeoJSON FeatureCollection", "write features with geometry");
  return json;
}

/// "EPSG:25832" of the names that GeoJSON has for it, such as "urn:ogc:def:crs:EPSG::25832".
std::string shortSystem(const std::string& name) {
  std::vector<std::string> words(1);
  for (const char c : name)
    if (c == ':' || c == '/')
      words.emplace_back();
    else
      words.back() += ('a' <= c && c <= 'z') ? static_cast<char>(c - 'a' + 'A') : c;
  const auto system = std::find(words.begin(), words.end(), "CRS");
  const auto authority = system == words.end() ? words.begin() : std::next(system);
  return authority == words.end() || authority + 1 == words.end() ? name : *authority + ":" + words.back();
}

/// The name in the member "crs", which older GeoJSON has and GDAL writes; empty when there is none.
std::string systemOf(const nlohmann::json& json) {
  const auto crs = json.find("crs");
  if (crs == json.end() || crs->is_null()) return {};
  const auto properties = crs->is_object() ? crs->find("properties") : crs->end();
  const nlohmann::json& named = properties != crs->end() && properties->is_object() ? *properties : *crs;
  const auto name = named.is_object() ? named.find("name") : named.end();
  return name != named.end() && name->is_string() ? shortSystem(name->get<std::string>()) : crs->dump();
}

PlaceReader geoJsonReader(const nlohmann::json& json, const std::filesystem::path& file,
                          const mapping::MapInputs& inputs) {
  static const std::set<std::string> degrees{"", "OGC:CRS84", "OGC:CRS84H", "EPSG:4326", "EPSG:4979", "EPSG:4258"};
  if (json.contains("frame")) return placeInMap;
  const std::string system = systemOf(json);
  if (degrees.contains(system))
    return degreesReader(file, inputs, "with the member \"frame\": \"map\", numbers are metres of the map frame");
  if (system == shortSystem(inputs.crs)) {
    const Eigen::Vector2d origin = inputs.map_origin.head<2>();
    return [origin](double x, double y) -> Eigen::Vector2d { return Eigen::Vector2d(x, y) - origin; };
  }
  throw InputError({.file = file.string()},
                   "its coordinate system (crs) is '" + system +
                       "', which is neither that of longitude and latitude nor that of the map" +
                       (inputs.crs.empty() ? ", which has none" : ", '" + inputs.crs + "'"),
                   "convert the file to longitude and latitude (WGS 84)");
}

/// A property as text; empty when it is not there, or null.
std::string textProperty(const nlohmann::json& feature, const char* name) {
  const auto properties = feature.find("properties");
  if (properties == feature.end() || !properties->is_object() || !properties->contains(name)) return {};
  const nlohmann::json& value = (*properties)[name];
  if (value.is_null()) return {};
  return value.is_string() ? value.get<std::string>() : value.dump();
}

bool isPosition(const nlohmann::json& json) {
  return json.is_array() && json.size() >= 2 && json[0].is_number() && json[1].is_number();
}

/// Empty for what is no array of positions.
std::vector<Eigen::Vector2d> positionsIn(const nlohmann::json& line, const PlaceReader& place) {
  if (!line.is_array() || !std::all_of(line.begin(), line.end(), isPosition)) return {};
  std::vector<Eigen::Vector2d> positions;
  for (const nlohmann::json& p : line) positions.push_back(place(p[0].get<double>(), p[1].get<double>()));
  return positions;
}

/// The type and the coordinates of a feature's geometry; null when it has none.
std::pair<std::string, nlohmann::json> geometryOf(const nlohmann::json& feature) {
  const auto geometry = feature.find("geometry");
  if (geometry == feature.end() || !geometry->is_object() || !geometry->contains("coordinates")) return {};
  const nlohmann::json type = geometry->value("type", nlohmann::json());
  return {type.is_string() ? type.get<std::string>() : "", (*geometry)["coordinates"]};
}

/// The positions of a Point (one) or of a LineString; empty for anything else.
std::vector<Eigen::Vector2d> positionsOf(const nlohmann::json& feature, const PlaceReader& place) {
  const auto [type, coordinates] = geometryOf(feature);
  return positionsIn(type == "LineString" ? coordinates : nlohmann::json::array({coordinates}), place);
}

/// The lines of a LineString or MultiLineString; none of anything else.
std::vector<std::vector<Eigen::Vector2d>> linesOf(const nlohmann::json& feature, const PlaceReader& place) {
  const auto [type, coordinates] = geometryOf(feature);
  std::vector<std::vector<Eigen::Vector2d>> lines;
  if (type == "LineString") lines.push_back(positionsIn(coordinates, place));
  if (type == "MultiLineString" && coordinates.is_array())
    for (const nlohmann::json& line : coordinates) lines.push_back(positionsIn(line, place));
  std::erase_if(lines, [](const auto& line) { return line.size() < 2; });
  return lines;
}

/// Where the inventory says that a thing with this line is.
Eigen::Vector2d placeOnLine(const std::vector<Eigen::Vector2d>& line, const std::string& class_iri) {
  if (class_iri != rdf::vocabulary::clx("ParkingRow")) return line[line.size() / 2];
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : line) sum += p;
  return sum / static_cast<double>(line.size());
}

std::vector<RegisterEntry> readGeoJsonRegister(const std::filesystem::path& file, const mapping::MapInputs& inputs,
                                               EntryReader reader) {
  const nlohmann::json json = geoJsonOf(file);
  const PlaceReader place = geoJsonReader(json, file, inputs);
  std::vector<RegisterEntry> entries;
  for (std::size_t i = 0; i < json["features"].size(); ++i) {
    const nlohmann::json& feature = json["features"][i];
    const std::string number = std::to_string(i + 1), named = textProperty(feature, "class");
    const std::string kind = named.empty() ? textProperty(feature, "kind") : named;
    const Diagnostic here{Severity::Error, {.file = file.string()}, "feature " + number + ": ", "", ""};
    const std::vector<Eigen::Vector2d> positions = positionsOf(feature, place);
    if (kind.empty() || positions.empty()) {
      reader.addFault(here, "it has no class or no place", "write a Point or LineString with the property class");
      continue;
    }
    RegisterEntry& entry = entries.emplace_back();
    const std::string id = textProperty(feature, "id");
    entry.id = id.empty() ? number : id;
    reader.read(entry, kind, textProperty(feature, "height"), here);
    entry.at = placeOnLine(positions, entry.class_iri);
  }
  reader.throwFaults();
  return entries;
}

}  // namespace

std::vector<RegisterEntry> readRegister(const std::filesystem::path& file, const mapping::MapInputs& inputs,
                                        const rdf::OntologyView& ontology) {
  const std::string ending = file.extension();
  if (ending == ".csv") return readCsvRegister(file, inputs, EntryReader(ontology, inputs));
  if (ending == ".geojson" || ending == ".json")
    return readGeoJsonRegister(file, inputs, EntryReader(ontology, inputs));
  throw InputError({.file = file.string()}, "a register is a file NAME.csv or NAME.geojson");
}

std::vector<Street> readStreets(const std::filesystem::path& file, const mapping::MapInputs& inputs,
                                ProgressSink& sink) {
  const nlohmann::json json = geoJsonOf(file);
  const PlaceReader place = geoJsonReader(json, file, inputs);
  std::vector<Street> streets;
  std::size_t without_line = 0, without_name = 0;
  for (const nlohmann::json& feature : json["features"]) {
    const auto lines = linesOf(feature, place);
    const std::string name = textProperty(feature, "name");
    if (lines.empty())
      ++without_line;
    else if (name.empty())
      ++without_name;
    else
      for (const auto& line : lines) streets.push_back({name, line});
  }
  const std::string left_out =
      "features without a line: " + std::to_string(without_line) + ", without a name: " + std::to_string(without_name);
  if (streets.empty())
    throw InputError({.file = file.string()}, "it holds no street (" + left_out + ")",
                     "write a LineString or MultiLineString with the property name");
  if (without_line + without_name > 0) sink.note(file.string() + ": left out are " + left_out);
  return streets;
}

}  // namespace cluxel::tasks
