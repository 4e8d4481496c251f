// SPDX-License-Identifier: Apache-2.0
// Reads the PLY header and finds the vertices after it.
#include "scan/formats/ply_format.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "scan/formats/text_scanner.hpp"
#include "scan/pcl/pcl_functions.hpp"

namespace cluxel::scan {

namespace {

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PointField> fields;
  bool has_lists = false;
};

enum class PlyData { Ascii, LittleEndian, BigEndian };

constexpr std::size_t kMaxProperties = 256;
constexpr std::array<std::pair<std::string_view, FieldType>, 16> kTypeNames{{{"char", FieldType::I8},
                                                                             {"int8", FieldType::I8},
                                                                             {"uchar", FieldType::U8},
                                                                             {"uint8", FieldType::U8},
                                                                             {"short", FieldType::I16},
                                                                             {"int16", FieldType::I16},
                                                                             {"ushort", FieldType::U16},
                                                                             {"uint16", FieldType::U16},
                                                                             {"int", FieldType::I32},
                                                                             {"int32", FieldType::I32},
                                                                             {"uint", FieldType::U32},
                                                                             {"uint32", FieldType::U32},
                                                                             {"float", FieldType::F32},
                                                                             {"float32", FieldType::F32},
                                                                             {"double", FieldType::F64},
                                                                             {"float64", FieldType::F64}}};

/// Reads the header word by word. TextScanner's '#' comments do no harm: no legal header line holds a '#' outside of
/// PLY's own comment lines.
class PlyHeaderParser {
 public:
  PlyHeaderParser(std::string_view bytes, const std::string& file) : scanner_(bytes, file), bytes_(bytes) {}

  void parse() {
    if (!scanner_.nextLine() || scanner_.currentLine() != "ply")
      refuseFile(scanner_.file(), "is not a PLY file: its first line is not 'ply'");
    while (scanner_.nextLine()) {
      const std::string_view keyword = scanner_.word("a keyword");
      if (keyword == "end_header") return finish();
      if (keyword == "comment" || keyword == "obj_info") continue;
      if (keyword == "format")
        readFormat();
      else if (keyword == "element")
        readElement();
      else if (keyword == "property")
        readProperty();
      else
        scanner_.refuse("'" + std::string(keyword.substr(0, 40)) + "' is not a keyword of a PLY header");
      scanner_.endLine("one keyword and its values");
    }
    scanner_.refuseEnd("the PLY header ends without a line end_header");
  }

  /// Stands after the header once parse() has returned.
  TextScanner& scanner() { return scanner_; }
  PlyData data() const { return *data_; }
  const std::vector<PlyElement>& elements() const { return elements_; }
  std::vector<PlyElement>& elements() { return elements_; }
  std::size_t bodyOffset() const { return body_offset_; }

 private:
  void readFormat() {
    const std::string_view name = scanner_.word("the format");
    if (name == "ascii")
      data_ = PlyData::Ascii;
    else if (name == "binary_little_endian")
      data_ = PlyData::LittleEndian;
    else if (name == "binary_big_endian")
      data_ = PlyData::BigEndian;
    else
      scanner_.refuse("unknown format", "known are ascii, binary_little_endian and binary_big_endian");
    if (scanner_.word("the version") != "1.0") scanner_.refuse("unknown version of PLY", "known is 1.0");
  }

  void readElement() {
    PlyElement element;
    element.name = scanner_.word("the name of the element");
    element.count = scanner_.count("the number of elements");
    if (elements_.size() == kMaxProperties) scanner_.refuse("more than 256 elements");
    elements_.push_back(std::move(element));
  }

  FieldType readType() {
    const std::string_view name = scanner_.word("a type");
    for (const auto& [known, type] : kTypeNames)
      if (known == name) return type;
    scanner_.refuse("'" + std::string(name.substr(0, 40)) + "' is not a type of PLY");
  }

  void readProperty() {
    if (elements_.empty()) scanner_.refuse("a property stands before the first element");
    PlyElement& element = elements_.back();
    if (element.fields.size() == kMaxProperties) scanner_.refuse("more than 256 properties");
    TextScanner ahead = scanner_;
    if (ahead.word("a type") == "list") {
      scanner_.word("list");
      readType();
      element.has_lists = true;
    }
    const FieldType type = readType();
    element.fields.push_back({std::string(scanner_.word("the name of the property")), type});
  }

  void finish() {
    scanner_.endLine("only end_header");
    if (!data_) scanner_.refuse("the header has no line format");
    const std::string_view line = scanner_.currentLine();
    const std::size_t line_end = static_cast<std::size_t>(line.data() - bytes_.data()) + line.size();
    const std::size_t newline = bytes_.find('\n', line_end);
    body_offset_ = newline == std::string_view::npos ? bytes_.size() : newline + 1;
  }

  TextScanner scanner_;
  std::string_view bytes_;
  std::optional<PlyData> data_;
  std::vector<PlyElement> elements_;
  std::size_t body_offset_ = 0;
};

/// The index of the element "vertex"; refuses headers whose vertices cannot be found or read.
std::size_t vertexElement(const PlyHeaderParser& header, const std::string& file) {
  for (std::size_t i = 0; i < header.elements().size(); ++i) {
    const PlyElement& element = header.elements()[i];
    if (element.has_lists)
      refuseFile(file, "the element '" + element.name + "' has lists but does not follow the vertices");
    if (element.name != "vertex") continue;
    if (element.count == 0) refuseFile(file, "holds no points", "an empty scan cannot be mapped: leave it out");
    return i;
  }
  refuseFile(file, "has no element 'vertex'");
}

ParsedScan fromText(PlyHeaderParser& header, std::size_t vertex) {
  TextScanner& lines = header.scanner();
  for (std::size_t i = 0; i < vertex; ++i)
    for (std::uint64_t k = 0; k < header.elements()[i].count; ++k)
      if (!lines.nextLine()) lines.refuseEnd("ends inside the element '" + header.elements()[i].name + "'");
  const PlyElement& vertices = header.elements()[vertex];
  ParsedScan scan = scanFromLines(lines, vertices.fields, {.count = vertices.count});
  if (vertex + 1 == header.elements().size() && lines.nextLine())
    lines.refuse("more points than the header's " + std::to_string(vertices.count));
  return scan;
}

ParsedScan fromBinary(const PlyHeaderParser& header, std::size_t vertex, std::string_view bytes,
                      const std::string& file) {
  std::uint64_t begin = header.bodyOffset();
  for (std::size_t i = 0; i < vertex; ++i)
    begin += header.elements()[i].count * recordBytes(header.elements()[i].fields);
  const PlyElement& vertices = header.elements()[vertex];
  rolesOf(vertices.fields, file);
  const std::uint64_t length = vertices.count * recordBytes(vertices.fields);
  const std::uint64_t there = begin < bytes.size() ? bytes.size() - begin : 0;
  if (there < length)
    refuseByte(
        file, bytes.size(),
        "the vertices take " + std::to_string(there) + " bytes where the header declares " + std::to_string(length),
        "the file is cut off");
  if (vertex + 1 == header.elements().size() && there != length)
    refuseByte(file, begin + length, std::to_string(there - length) + " bytes follow the last vertex",
               "the header and the data are not of the same cloud");
  const std::string records = pcl().plyRecords(bytes.substr(begin, length), vertices.fields, vertices.count,
                                               header.data() == PlyData::BigEndian, file);
  return scanFromRecords(records, vertices.fields, {.count = vertices.count, .body_offset = begin}, file);
}

/// Names the field "label", which is preferred to all other names of labels.
void useAsLabel(std::vector<PointField>& fields, const std::string& label_field, const std::string& file) {
  const auto is_chosen = [&](const PointField& field) { return field.name == label_field; };
  const auto chosen = std::find_if(fields.begin(), fields.end(), is_chosen);
  if (chosen == fields.end()) refuseFile(file, "has no field '" + label_field + "'");
  for (PointField& field : fields)
    if (field.name == "label") field.name = "other label";
  chosen->name = "label";
}

ParsedScan fromBody(PlyHeaderParser& header, std::size_t vertex, std::string_view bytes, const std::string& file) {
  if (header.data() == PlyData::Ascii) return fromText(header, vertex);
  return fromBinary(header, vertex, bytes, file);
}

}  // namespace

ParsedScan parsePly(std::string_view bytes, const std::string& file) {
  PlyHeaderParser header(bytes, file);
  header.parse();
  return fromBody(header, vertexElement(header, file), bytes, file);
}

ParsedScan parsePly(std::string_view bytes, const std::string& file, const std::string& label_field) {
  PlyHeaderParser header(bytes, file);
  header.parse();
  const std::size_t vertex = vertexElement(header, file);
  useAsLabel(header.elements()[vertex].fields, label_field, file);
  return fromBody(header, vertex, bytes, file);
}

}  // namespace cluxel::scan
