// SPDX-License-Identifier: Apache-2.0
// The four text formats of scans.
#include "scan/formats/text_formats.hpp"

#include "scan/formats/text_scanner.hpp"

namespace cluxel::scan {

namespace {

constexpr const char* kXyzLine = "x y z, or x y z intensity";

/// Adds x y z; false for a line without a return, whose other values do not count.
bool addPoint(TextScanner& scanner, PointCollector& points) {
  const double x = scanner.anyNumber("x");
  const double y = scanner.anyNumber("y");
  const double z = scanner.anyNumber("z");
  const PointUse use = points.add(x, y, z);
  if (use == PointUse::OutOfRange) scanner.refuse(std::string("the point ") + kOutOfRange);
  return use == PointUse::Added;
}

float intensityOf(TextScanner& scanner) {
  const auto intensity = static_cast<float>(scanner.number("intensity"));
  if (!std::isfinite(intensity)) scanner.refuse("intensity is beyond the range of a float");
  return intensity;
}

/// Names the end of the text for an empty file, else as requirePoints().
void requirePointsOfText(const TextScanner& scanner, const ParsedScan& scan) {
  if (scan.points.empty() && scan.no_return.empty())
    scanner.refuseEnd("holds no points", "an empty scan cannot be mapped: leave it out");
  requirePoints(scan, scanner.file());
}

}  // namespace

ParsedScan parseXyzText(std::string_view bytes, const std::string& file) {
  TextScanner scanner(bytes, file);
  ParsedScan scan;
  PointCollector points(scan);
  bool first = true, with_intensity = false;
  while (scanner.nextLine()) {
    const bool added = addPoint(scanner, points);
    if (first) with_intensity = !scanner.atLineEnd();
    first = false;
    if (with_intensity && added)
      scan.points.intensity.push_back(intensityOf(scanner));
    else if (with_intensity)
      scanner.anyNumber("intensity");
    scanner.endLine(with_intensity ? "x y z intensity in this file" : kXyzLine);
  }
  requirePointsOfText(scanner, scan);
  return scan;
}

ParsedScan parseLabelledText(std::string_view bytes, const std::string& file) {
  TextScanner scanner(bytes, file);
  ParsedScan scan;
  PointCollector points(scan);
  while (scanner.nextLine()) {
    const bool added = addPoint(scanner, points);
    const std::uint32_t label = scanner.label("label");
    if (added) scan.points.label.push_back(label);
    scanner.number("confidence");
    scanner.endLine("x y z label confidence");
  }
  requirePointsOfText(scanner, scan);
  return scan;
}

ParsedScan parseFreiburgPoints(std::string_view bytes, const std::string& file) {
  TextScanner scanner(bytes, file);
  ParsedScan scan;
  PointCollector points(scan);
  while (scanner.nextLine()) {
    const double ox = scanner.number("sx"), oy = scanner.number("sy"), oz = scanner.number("sz");
    if (addPoint(scanner, points) && !points.addOrigin({ox, oy, oz}))
      scanner.refuse("the origin is beyond the range of a float");
    scanner.endLine("sx sy sz x y z");
  }
  requirePointsOfText(scanner, scan);
  return scan;
}

std::vector<std::uint32_t> parseLabelLines(std::string_view bytes, const std::string& file, std::size_t point_count) {
  TextScanner scanner(bytes, file);
  std::vector<std::uint32_t> labels;
  labels.reserve(point_count);
  while (scanner.nextLine()) {
    if (labels.size() == point_count)
      scanner.refuse("more labels than the scan's " + std::to_string(point_count) + " points");
    labels.push_back(scanner.label("label"));
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

}  // namespace cluxel::scan
