// SPDX-License-Identifier: Apache-2.0
// Reads registers and streets: CSV and GeoJSON.
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/file_bytes.hpp"
#include "base/nearest_name.hpp"
#include "base/utf8.hpp"
#include "cluxel/error.hpp"
#include "tasks/export/proj_geo_reference.hpp"
#include "tasks/inventory/register.hpp"

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

PlaceReader readerOf(bool is_degrees, const std::filesystem::path& file, const mapping::MapInputs& inputs) {
  if (!is_degrees) return [](double x, double y) { return Eigen::Vector2d(x, y); };
  if (inputs.crs.empty())
    throw InputError({.file = file.string()}, "it has longitude and latitude, but the map has no coordinate system",
                     "write x and y in metres of the map frame");
  const auto earth = std::make_shared<GeoReference>(inputs.crs, inputs.map_origin);
  return [earth](double lon, double lat) { return mapPlaceOf(*earth, {lon, lat}); };
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

std::optional<double> registerNumber(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_read = error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
  return is_read ? std::optional(value) : std::nullopt;
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

std::vector<RegisterEntry> readCsvRegister(const std::filesystem::path& file, const mapping::MapInputs& inputs) {
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
  const PlaceReader place = readerOf(is_degrees, file, inputs);
  std::vector<RegisterEntry> entries;
  std::vector<Diagnostic> faults;
  for (std::size_t number = 2; std::getline(lines, line); ++number) {
    const std::vector<std::string> fields = csvFields(line);
    if (fields.size() == 1 && fields[0].empty()) continue;
    const auto px = x < fields.size() ? registerNumber(fields[x]) : std::nullopt;
    const auto py = y < fields.size() ? registerNumber(fields[y]) : std::nullopt;
    if (!px || !py || kind >= fields.size() || fields[kind].empty()) {
      faults.push_back({Severity::Error,
                        {file.string(), number, 1, std::nullopt},
                        "the line has no class or no place",
                        "write numbers with a point",
                        line});
      continue;
    }
    entries.push_back({id < fields.size() ? fields[id] : std::to_string(number - 1), fields[kind], place(*px, *py),
                       height < fields.size() ? registerNumber(fields[height]) : std::nullopt});
  }
  if (!faults.empty()) throw InputError(std::move(faults));
  return entries;
}

nlohmann::json geoJsonOf(const std::filesystem::path& file) {
  nlohmann::json json = nlohmann::json::parse(readFile(file), nullptr, false);
  if (json.is_discarded() || !json.is_object() || !json.contains("features") || !json["features"].is_array())
    throw InputError({.file = file.string()}, "it is no GeoJSON FeatureCollection", "write features with geometry");
  return json;
}

PlaceReader geoJsonReader(const nlohmann::json& json, const std::filesystem::path& file,
                          const mapping::MapInputs& inputs) {
  return readerOf(!json.contains("frame"), file, inputs);
}

std::string textProperty(const nlohmann::json& feature, const char* name) {
  const auto properties = feature.find("properties");
  if (properties == feature.end() || !properties->is_object() || !properties->contains(name)) return {};
  const nlohmann::json& value = (*properties)[name];
  return value.is_string() ? value.get<std::string>() : value.dump();
}

bool isPosition(const nlohmann::json& json) {
  return json.is_array() && json.size() >= 2 && json[0].is_number() && json[1].is_number();
}

InputError faultyFeature(const std::filesystem::path& file, std::size_t number, const std::string& wanted) {
  return {{.file = file.string()}, "feature " + std::to_string(number + 1) + " cannot be read", wanted};
}

std::vector<RegisterEntry> readGeoJsonRegister(const std::filesystem::path& file, const mapping::MapInputs& inputs) {
  const nlohmann::json json = geoJsonOf(file);
  const PlaceReader place = geoJsonReader(json, file, inputs);
  std::vector<RegisterEntry> entries;
  for (std::size_t i = 0; i < json["features"].size(); ++i) {
    const nlohmann::json& feature = json["features"][i];
    RegisterEntry entry;
    entry.kind = textProperty(feature, "class");
    if (entry.kind.empty()) entry.kind = textProperty(feature, "kind");
    const nlohmann::json position =
        feature.is_object() ? feature.value("/geometry/coordinates"_json_pointer, nlohmann::json()) : nlohmann::json();
    if (entry.kind.empty() || !isPosition(position))
      throw faultyFeature(file, i, "write a Point with the property class");
    entry.at = place(position[0].get<double>(), position[1].get<double>());
    entry.id = textProperty(feature, "id");
    if (entry.id.empty()) entry.id = std::to_string(i + 1);
    entry.height_m = registerNumber(textProperty(feature, "height"));
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace

std::vector<RegisterEntry> readRegister(const std::filesystem::path& file, const mapping::MapInputs& inputs) {
  const std::string ending = file.extension();
  if (ending == ".csv") return readCsvRegister(file, inputs);
  if (ending == ".geojson" || ending == ".json") return readGeoJsonRegister(file, inputs);
  throw InputError({.file = file.string()}, "a register is a file NAME.csv or NAME.geojson");
}

std::vector<Street> readStreets(const std::filesystem::path& file, const mapping::MapInputs& inputs) {
  const nlohmann::json json = geoJsonOf(file);
  const PlaceReader place = geoJsonReader(json, file, inputs);
  std::vector<Street> streets;
  for (std::size_t i = 0; i < json["features"].size(); ++i) {
    const nlohmann::json& feature = json["features"][i];
    Street street{textProperty(feature, "name"), {}};
    const nlohmann::json line =
        feature.is_object() ? feature.value("/geometry/coordinates"_json_pointer, nlohmann::json()) : nlohmann::json();
    const bool is_line = line.is_array() && !line.empty() && std::all_of(line.begin(), line.end(), isPosition);
    if (street.name.empty() || !is_line) throw faultyFeature(file, i, "write a LineString with the property name");
    for (const nlohmann::json& p : line) street.course.push_back(place(p[0].get<double>(), p[1].get<double>()));
    streets.push_back(std::move(street));
  }
  return streets;
}

}  // namespace cluxel::tasks
