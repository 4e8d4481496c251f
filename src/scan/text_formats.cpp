// SPDX-License-Identifier: Apache-2.0
// The four text formats of scans.
#include "scan/text_formats.hpp"

#include "scan/text_scanner.hpp"

namespace cluxel {

namespace {

constexpr const char* kXyzLine = "x y z, or x y z intensity";

void addPoint(TextScanner& scanner, PointCollector& points) {
  const double x = scanner.number("x");
  const double y = scanner.number("y");
  const double z = scanner.number("z");
  if (!points.add(x, y, z)) scanner.refuse(std::string("the point ") + kUnusableCoordinate);
}

float intensityOf(TextScanner& scanner) {
  const auto intensity = static_cast<float>(scanner.number("intensity"));
  if (!std::isfinite(intensity)) scanner.refuse("intensity is beyond the range of a float");
  return intensity;
}

void refuseIfEmpty(const TextScanner& scanner, const ParsedScan& scan) {
  if (scan.points.empty()) scanner.refuseEnd("holds no points", "an empty scan cannot be mapped: leave it out");
}

}  // namespace

ParsedScan parseXyzText(std::string_view bytes, const std::string& file) {
  TextScanner scanner(bytes, file);
  ParsedScan scan;
  PointCollector points(scan);
  bool with_intensity = false;
  while (scanner.nextLine()) {
    const bool first = scan.points.empty();
    addPoint(scanner, points);
    if (first) with_intensity = !scanner.atLineEnd();
    if (with_intensity) scan.points.intensity.push_back(intensityOf(scanner));
    scanner.endLine(with_intensity ? "x y z intensity in this file" : kXyzLine);
  }
  refuseIfEmpty(scanner, scan);
  return scan;
}

ParsedScan parseLabelledText(std::string_view bytes, const std::string& file) {
  TextScanner scanner(bytes, file);
  ParsedScan scan;
  PointCollector points(scan);
  while (scanner.nextLine()) {
    addPoint(scanner, points);
    scan.points.label.push_back(scanner.count("label"));
    scanner.number("confidence");
    scanner.endLine("x y z label confidence");
  }
  refuseIfEmpty(scanner, scan);
  return scan;
}

ParsedScan parseFreiburgPoints(std::string_view bytes, const std::string& file) {
  TextScanner scanner(bytes, file);
  ParsedScan scan;
  PointCollector points(scan);
  while (scanner.nextLine()) {
    const auto ox = static_cast<float>(scanner.number("sx"));
    const auto oy = static_cast<float>(scanner.number("sy"));
    const auto oz = static_cast<float>(scanner.number("sz"));
    if (!std::isfinite(ox + oy + oz)) scanner.refuse("the origin is beyond the range of a float");
    scan.points.origin.emplace_back(ox, oy, oz);
    addPoint(scanner, points);
    scanner.endLine("sx sy sz x y z");
  }
  refuseIfEmpty(scanner, scan);
  return scan;
}

std::vector<std::uint32_t> parseLabelLines(std::string_view bytes, const std::string& file, std::size_t point_count) {
  TextScanner scanner(bytes, file);
  std::vector<std::uint32_t> labels;
  labels.reserve(point_count);
  while (scanner.nextLine()) {
    if (labels.size() == point_count)
      scanner.refuse("more labels than the scan's " + std::to_string(point_count) + " points");
    labels.push_back(scanner.count("label"));
    scanner.endLine("one label id");
  }
  if (labels.size() != point_count)
    scanner.refuseEnd("ends after " + std::to_string(labels.size()) + " labels for " + std::to_string(point_count) +
                      " points");
  return labels;
}

std::size_t columnsOfFirstLine(std::string_view bytes) {
  TextScanner scanner(bytes, {});
  if (!scanner.nextLine()) return 0;
  std::size_t columns = 0;
  for (; !scanner.atLineEnd(); ++columns) scanner.word("a column");
  return columns;
}

}  // namespace cluxel
