// SPDX-License-Identifier: Apache-2.0
// Adds the options and puts them into the parameters of the library.
#include "app/shared_options.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "rdf/file/map_check.hpp"

namespace cluxel::app {

scan::ScanSetParams ScanOptions::params() const {
  return {.poses = poses,
          .frame = frame,
          .remedies = {.poses = "name a poses file with --poses FILE",
                       .unit = frame.unit == scan::LengthUnit::Metre
                                   ? "state the unit with --units mm, cm, m, ft or us-ft"
                                   : "check --units " + std::string(scan::nameOf(frame.unit)),
                       .up = frame.up == scan::UpAxis::Y ? "leave --up y out" : "state the up axis with --up y"}};
}

void addScanOptions(CLI::App& command, ScanOptions& options) {
  using scan::LengthUnit;
  using scan::UpAxis;
  const std::map<std::string, LengthUnit> units{{"m", LengthUnit::Metre},
                                                {"cm", LengthUnit::Centimetre},
                                                {"mm", LengthUnit::Millimetre},
                                                {"ft", LengthUnit::Foot},
                                                {"us-ft", LengthUnit::UsSurveyFoot}};
  const std::map<std::string, UpAxis> axes{{"z", UpAxis::Z}, {"y", UpAxis::Y}};
  command.add_option("--poses", options.poses, "poses of the scans: KITTI 3x4, TUM, or 4x4 text");
  command.add_option("--units", options.frame.unit, "unit of the scans and poses: m (default), cm, mm, ft or us-ft")
      ->transform(wordFor(units, "UNIT"));
  command.add_option("--up", options.frame.up, "axis of the scans and poses that points up: z (default) or y")
      ->transform(wordFor(axes, "AXIS"));
}

void BudgetOptions::applyTo(sparql::QueryBudget& budget) const {
  constexpr double kMaxDeadline_s = 1e9;
  constexpr std::uint64_t kMaxMemory_mib = std::uint64_t{1} << 40U;
  if (deadline_s > 0)
    budget.deadline = std::chrono::milliseconds(std::llround(std::min(deadline_s, kMaxDeadline_s) * 1000));
  if (max_memory_mib > 0) budget.max_memory_bytes = std::min(max_memory_mib, kMaxMemory_mib) << 20U;
}

void addBudget(CLI::App& command, BudgetOptions& options) {
  command.add_option("--deadline", options.deadline_s, "seconds after which the command fails with exit code 6")
      ->check(above0());
  command.add_option("--max-memory", options.max_memory_mib, "MiB above which the command fails with exit code 6")
      ->check(wholeAbove0());
}

void addAuthor(CLI::App& command, std::string& author) {
  command.add_option("--author", author, "author of the statements, for the history (default: the user's name)")
      ->check(validText());
}

std::string authorOr(const std::string& given) {
  if (!given.empty()) return given;
  const char* user = std::getenv("USER");
  return user == nullptr ? "" : user;
}

void addHtmlFile(CLI::App& command, fs::path& file) {
  command.add_option("--html", file, "also write figures, as one HTML file")->check(named());
}

void refuseToReplaceMap(const fs::path& output) {
  std::error_code ignored;
  if (fs::is_regular_file(output, ignored) && rdf::looksLikeMap(output))
    throw Error(ErrorKind::StoreUnavailable,
                output.string() + ": is a map, which the output would replace; name another file");
}

void writeOutput(const fs::path& output, std::string_view bytes) {
  refuseToReplaceMap(output);
  writeFile(output, bytes);
}

}  // namespace cluxel::app
