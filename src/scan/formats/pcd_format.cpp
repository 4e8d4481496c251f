// SPDX-License-Identifier: Apache-2.0
// The PCD header is checked completely before the data are read.
#include "scan/formats/pcd_format.hpp"

#include <array>
#include <map>

#include "scan/formats/little_endian.hpp"
#include "scan/formats/text_scanner.hpp"
#include "scan/pcl/pcl_functions.hpp"

namespace cluxel::scan {

namespace {

enum class PcdData { Ascii, Binary, Compressed };

struct PcdHeader {
  std::vector<PointField> fields;
  std::uint64_t width = 0, height = 1;
  std::optional<std::uint64_t> points;
  std::array<double, 7> viewpoint{0, 0, 0, 1, 0, 0, 0};  ///< tx ty tz qw qx qy qz
  PcdData data = PcdData::Ascii;
  std::size_t body_offset = 0;
};

constexpr std::size_t kMaxFields = 256;
constexpr std::size_t kMaxNumbersPerField = 4096;
constexpr std::uint64_t kMaxPoints = 0xFFFFFFFFU;
/// LZF encodes at most 264 bytes in 3.
constexpr std::uint64_t kMaxLzfRatio = 88;

/// Reads the header line by line; each keyword may come once.
class PcdHeaderParser {
 public:
  PcdHeaderParser(std::string_view bytes, const std::string& file) : scanner_(bytes, file), bytes_(bytes) {}

  /// Leaves the scanner after the DATA line.
  PcdHeader parse() {
    while (scanner_.nextLine()) {
      const std::string keyword(scanner_.word("a keyword"));
      if (++seen_[keyword] > 1) scanner_.refuse(keyword + " stands twice in the header");
      if (keyword == "DATA") return finish();
      readEntry(keyword);
    }
    scanner_.refuseEnd("the PCD header ends without a DATA line");
  }
  TextScanner& scanner() { return scanner_; }

 private:
  void readEntry(const std::string& keyword) {
    if (keyword == "VERSION")
      scanner_.word("the version");
    else if (keyword == "FIELDS")
      readFields();
    else if (keyword == "SIZE")
      readSizes();
    else if (keyword == "TYPE")
      readTypes();
    else if (keyword == "COUNT")
      readCounts();
    else if (keyword == "WIDTH")
      header_.width = scanner_.count("the width");
    else if (keyword == "HEIGHT")
      header_.height = scanner_.count("the height");
    else if (keyword == "POINTS")
      header_.points = scanner_.count("the number of points");
    else if (keyword == "VIEWPOINT")
      for (double& value : header_.viewpoint) value = scanner_.number("VIEWPOINT");
    else
      scanner_.refuse("'" + keyword.substr(0, 40) + "' is not a keyword of a PCD header");
    scanner_.endLine("one keyword and its values, one for each field");
  }

  void readFields() {
    while (!scanner_.atLineEnd()) header_.fields.push_back({std::string(scanner_.word("a field name"))});
    if (header_.fields.size() > kMaxFields) scanner_.refuse("more than 256 fields");
    sizes_.assign(header_.fields.size(), 4);
    types_.assign(header_.fields.size(), 'F');
  }

  void readSizes() {
    for (std::uint32_t& size : sizes_) size = scanner_.count("SIZE");
  }

  void readTypes() {
    for (char& type : types_) {
      const std::string_view word = scanner_.word("TYPE");
      if (word != "I" && word != "U" && word != "F") scanner_.refuse("unknown TYPE, known are I, U and F");
      type = word[0];
    }
  }

  void readCounts() {
    for (PointField& field : header_.fields) {
      field.count = scanner_.count("COUNT");
      if (field.count == 0 || field.count > kMaxNumbersPerField) scanner_.refuse("COUNT is out of range");
    }
  }

  FieldType typeOf(char type, std::uint32_t size) const {
    const bool is_float = type == 'F';
    const bool known = size == 4 || size == 8 || (!is_float && (size == 1 || size == 2));
    if (!known) scanner_.refuse(std::string("no field has TYPE ") + type + " and SIZE " + std::to_string(size));
    if (is_float) return size == 4 ? FieldType::F32 : FieldType::F64;
    const int first = size == 1 ? 0 : size == 2 ? 2 : size == 4 ? 4 : 6;
    return static_cast<FieldType>(first + (type == 'U' ? 1 : 0));
  }

  PcdHeader finish() {
    for (const char* needed : {"FIELDS", "SIZE", "TYPE", "WIDTH"})
      if (seen_[needed] == 0) scanner_.refuse(std::string("the header has no line ") + needed);
    for (std::size_t i = 0; i < header_.fields.size(); ++i) header_.fields[i].type = typeOf(types_[i], sizes_[i]);
    const std::string_view data = scanner_.word("DATA");
    if (data == "ascii")
      header_.data = PcdData::Ascii;
    else if (data == "binary")
      header_.data = PcdData::Binary;
    else if (data == "binary_compressed")
      header_.data = PcdData::Compressed;
    else
      scanner_.refuse("unknown DATA", "known are ascii, binary and binary_compressed");
    const auto line_end =
        static_cast<std::size_t>(scanner_.currentLine().data() - bytes_.data()) + scanner_.currentLine().size();
    const std::size_t newline = bytes_.find('\n', line_end);
    header_.body_offset = newline == std::string_view::npos ? bytes_.size() : newline + 1;
    checkCount();
    return header_;
  }

  void checkCount() const {
    const std::uint64_t count = header_.width * header_.height;
    if (header_.points && *header_.points != count)
      scanner_.refuse("POINTS is " + std::to_string(*header_.points) + " but WIDTH times HEIGHT is " +
                      std::to_string(count));
    if (count > kMaxPoints) scanner_.refuse("WIDTH times HEIGHT is more than 4294967295 points");
    if (count == 0) scanner_.refuse("holds no points", "an empty scan cannot be mapped: leave it out");
  }

  TextScanner scanner_;
  std::string_view bytes_;
  PcdHeader header_;
  std::map<std::string, int> seen_;
  std::vector<std::uint32_t> sizes_;
  std::vector<char> types_;
};

std::optional<Eigen::Isometry3d> viewpointOf(const PcdHeader& header, const std::string& file) {
  const std::array<double, 7>& v = header.viewpoint;
  const Eigen::Quaterniond rotation(v[3], v[4], v[5], v[6]);
  if (std::abs(rotation.norm() - 1) > 1e-3) refuseFile(file, "the quaternion of VIEWPOINT does not have length 1");
  Eigen::Isometry3d T_map_sensor = Eigen::Isometry3d::Identity();
  T_map_sensor.linear() = rotation.normalized().toRotationMatrix();
  T_map_sensor.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
  if (T_map_sensor.matrix().isIdentity(0)) return std::nullopt;
  return T_map_sensor;
}

void checkLength(std::uint64_t there, std::uint64_t expected, const std::string& file, std::uint64_t file_end) {
  if (there == expected) return;
  refuseByte(
      file, file_end,
      "the points take " + std::to_string(there) + " bytes where the header declares " + std::to_string(expected),
      there < expected ? "the file is cut off" : "the header and the data are not of the same cloud");
}

RecordRange rangeOf(const PcdHeader& header) {
  return {.count = header.width * header.height,
          .grid = header.height > 1 ? CloudGrid::Organised : CloudGrid::Unorganised,
          .body_offset = header.body_offset};
}

ParsedScan fromBinary(const PcdHeader& header, std::string_view body, std::size_t count, const std::string& file) {
  const std::size_t stride = recordBytes(header.fields);
  checkLength(body.size(), count * stride, file, header.body_offset + body.size());
  return scanFromRecords(pcl().pcdRecords(body, header.fields, count, false, file), header.fields, rangeOf(header),
                         file);
}

ParsedScan fromCompressed(const PcdHeader& header, std::string_view body, std::size_t count, const std::string& file) {
  std::vector<PointField> stored;
  for (const PointField& field : header.fields)
    if (field.name != "_") stored.push_back(field);
  const std::uint64_t body_end = header.body_offset + body.size();
  if (body.size() < 8) refuseByte(file, body_end, "the sizes of the compressed data are cut off");
  const std::uint64_t packed = numberAt<std::uint32_t>(body, 0);
  const std::uint64_t unpacked = numberAt<std::uint32_t>(body, 4);
  checkLength(body.size() - 8, packed, file, body_end);
  const std::size_t stride = recordBytes(stored);
  if (stored.empty() || count > unpacked / stride || unpacked != count * stride || unpacked > packed * kMaxLzfRatio)
    refuseByte(file, header.body_offset + 4,
               "the size of the unpacked data, " + std::to_string(unpacked) +
                   ", does not fit the header or the compressed data");
  return scanFromRecords(pcl().pcdRecords(body, stored, count, true, file), stored, rangeOf(header), file);
}

}  // namespace

ParsedScan parsePcd(std::string_view bytes, const std::string& file) {
  PcdHeaderParser parser(bytes, file);
  const PcdHeader header = parser.parse();
  const std::size_t count = header.width * header.height;
  const std::string_view body = bytes.substr(header.body_offset);
  ParsedScan scan;
  if (header.data == PcdData::Ascii) {
    TextScanner& lines = parser.scanner();
    scan = scanFromLines(lines, header.fields, rangeOf(header));
    if (lines.nextLine()) lines.refuse("more points than the header's " + std::to_string(count));
  } else if (header.data == PcdData::Binary) {
    scan = fromBinary(header, body, count, file);
  } else {
    scan = fromCompressed(header, body, count, file);
  }
  scan.viewpoint = viewpointOf(header, file);
  return scan;
}

std::optional<Eigen::Isometry3d> pcdViewpoint(std::string_view head, const std::string& file) {
  return viewpointOf(PcdHeaderParser(head, file).parse(), file);
}

}  // namespace cluxel::scan
