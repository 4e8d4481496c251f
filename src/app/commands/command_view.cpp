// SPDX-License-Identifier: Apache-2.0
// `cluxel view`: a map as one HTML page.
#include <array>
#include <cmath>

#include "app/command.hpp"
#include "app/map_condition.hpp"
#include "app/shared_options.hpp"
#include "tasks/view/view_page.hpp"

namespace cluxel::app {

namespace {

struct ViewArguments {
  fs::path map, output;
  std::uint64_t max_points = tasks::ViewOptions{}.max_points;
  std::uint64_t max_quads = tasks::ViewOptions{}.max_quads;
  bool without_reasons = false, allow_unfinished = false;
};

double megabytes(std::uint64_t bytes) {
  return std::round(static_cast<double>(bytes) / 1e5) / 10;
}

Json reportJson(const tasks::ViewReport& report) {
  return {{"points", report.points},
          {"points_in_map", report.points_in_map},
          {"objects", report.objects},
          {"quads", report.quads},
          {"quads_left_out", report.quads_left_out},
          {"program_bytes", report.program_bytes},
          {"point_bytes", report.point_bytes},
          {"quad_bytes", report.quad_bytes},
          {"object_bytes", report.object_bytes}};
}

std::string reportText(const fs::path& output, const tasks::ViewReport& report) {
  std::array<char, 64> size{};
  std::snprintf(size.data(), size.size(), "%.1f MB",
                megabytes(report.program_bytes + report.point_bytes + report.quad_bytes + report.object_bytes));
  std::string text = output.string() + ": " + size.data() + ", " + std::to_string(report.points);
  if (report.points < report.points_in_map) text += " of " + std::to_string(report.points_in_map);
  return text + " points, " + std::to_string(report.objects) + " objects, " + std::to_string(report.quads) +
         " quads; open it in a browser";
}

ExitCode view(const ViewArguments& arguments, Session& session) {
  refuseToReplaceMap(arguments.output);
  const mapping::MapReader map(arguments.map);
  const DataHome home = session.dataHome();
  const std::string page = tasks::viewTemplate(home);
  noteUnfinished(arguments.map, map.isFinished(), arguments.allow_unfinished, session);
  const tasks::ViewOptions options{
      arguments.map.stem().string(), arguments.max_points, arguments.max_quads, !arguments.without_reasons, false,
      session.threadCount()};
  std::string bytes;
  const tasks::ViewReport report = writeViewPage(map, page, tasks::shippedQuestions(home), options,
                                                 [&bytes](std::string_view piece) { bytes.append(piece); });
  writeOutput(arguments.output, bytes);
  if (session.json)
    printJson(reportJson(report));
  else
    print(reportText(arguments.output, report));
  return ExitCode::Done;
}

}  // namespace

void addView(CLI::App& app, Session& session) {
  auto options = std::make_shared<ViewArguments>();
  CLI::App* command = app.add_subcommand("view", "write a map as one HTML page with points, questions and reasons");
  command->add_option("map", options->map, "a map")->required();
  command->add_option("-o,--output", options->output, "the page to write")->required()->check(named());
  command
      ->add_option("--max-points", options->max_points,
                   "about how many points to show at most; a larger map is sampled evenly")
      ->check(wholeAbove0());
  command
      ->add_option("--max-quads", options->max_quads,
                   "largest number of quads; above it, quads about primitives are left out")
      ->check(wholeAbove0());
  command->add_flag("--without-reasons", options->without_reasons, "leave out the explanations of objects");
  addAllowUnfinished(*command, options->allow_unfinished);
  onRun(*command, session, [options, &session] { return view(*options, session); });
}

}  // namespace cluxel::app
