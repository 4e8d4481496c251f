// SPDX-License-Identifier: Apache-2.0
// `cluxel build`: scans in, one map file out.
#include <array>

#include "app/command.hpp"
#include "cluxel/base/diagnostic.hpp"
#include "cluxel/mapping/map_builder.hpp"
#include "cluxel/scan/pose_registration.hpp"

namespace cluxel::app {

namespace {

struct BuildOptions {
  std::vector<fs::path> inputs;
  fs::path poses, output;
  MapInputFiles files;
  BuildParams params;
  bool mend_poses = false;
};

/// The same scans with poses that fit each other; what was done is a note.
ScanSet withMendedPoses(const ScanSet& scans, Session& session) {
  const PoseRegistration mended = registerPoses(scans, {}, session.threadCount(), session.console);
  std::size_t used = 0, kept = 0;
  for (const RegisteredPair& pair : mended.pairs) used += pair.outcome == PairOutcome::Used ? 1 : 0;
  for (const MendedScan& scan : mended.scans) kept += scan.pairs == 0 ? 1 : 0;
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(),
                "poses mended: %zu of %zu pairs of scans used, median residual %.3f m before, %.3f m after; %zu of %zu scans keep their pose",
                used, mended.pairs.size(), mended.residual_before_m, mended.residual_after_m, kept, mended.scans.size());
  session.console.note(text.data());
  return scans.posed(mended.poses());
}

/// Poses that do not fit each other spoil labels long before anybody sees it in the map. A look at six scans at most; whatever
/// is wrong with the files themselves, the build says.
void noteDoubtfulPoses(const ScanSet& scans, Session& session) {
  const std::vector<PosedScan> sample = sampledNeighbours(scans);
  if (sample.empty()) return;
  double residual_m = 0;
  try {
    residual_m = measurePoses(scans.posed(sample), {}, session.threadCount(), session.console).residual_before_m;
  } catch (const Error&) {
    return;
  }
  if (residual_m <= kFittingResidual_m) return;
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(),
                "poses do not fit each other: surfaces of neighbouring scans lie %.2f m apart, in the median of those looked at; "
                "--register mends them",
                residual_m);
  session.console.note(text.data());
}

ExitCode build(const BuildOptions& options, Session& session) {
  const ScanSet given = ScanSet::open(options.inputs, {options.poses}, session.console);
  const MapInputs inputs = readMapInputs(options.files, session.dataHome());
  BuildParams params = options.params;
  params.threads = session.threadCount();
  if (!options.mend_poses) noteDoubtfulPoses(given, session);
  const ScanSet scans = options.mend_poses ? withMendedPoses(given, session) : given;
  const BuildReport report = buildMap(scans, inputs, options.output, params, session.console);
  if (session.json) {
    printJson(Json{{"map", options.output.string()}, {"scans", report.scans}, {"points", report.points},
               {"tiles", report.tiles}, {"cluxels", report.cluxels}, {"primitives", report.primitives},
               {"objects", report.objects}, {"quads", report.quads},
               {"scans_already_there", report.scans_already_there}});
    return ExitCode::Done;
  }
  std::printf("%s: %zu scans, %llu points in %zu tiles, %zu cluxels, %zu primitives, %zu objects, %llu quads\n",
              options.output.c_str(), report.scans, static_cast<unsigned long long>(report.points), report.tiles,
              report.cluxels, report.primitives, report.objects, static_cast<unsigned long long>(report.quads));
  return ExitCode::Done;
}

}  // namespace

void addBuild(CLI::App& app, Session& session) {
  auto options = std::make_shared<BuildOptions>();
  CLI::App* command = app.add_subcommand("build", "make a map from scans");
  command->add_option("scans", options->inputs, "files, folders and manifests of scans")->required();
  command->add_option("-o,--output", options->output, "the map file to make")->required();
  command->add_option("--poses", options->poses, "poses of the scans: KITTI 3x4, TUM, or 4x4 text");
  command->add_flag("--register", options->mend_poses, "mend the poses first, as the command register does");
  command->add_option("--model", options->files.model, "a trained model: a name in models/, a folder or a file");
  command->add_option("--rules", options->files.rules, "rule files instead of rules/outdoor.rules.yaml");
  command->add_option("--sparql-rules", options->files.sparql_rules, "CONSTRUCT rules instead of rules/*.rq");
  command->add_option("--ontology", options->files.ontology, "ontology files instead of ontology/*.ttl");
  command->add_option("--batch-points", options->params.batch_points, "commit when a batch of scans has this many points")
      ->check(above0());
  CLI::Option* force =
      command->add_flag("--force", options->params.force, "replace a finished map; the operator's statements stay");
  command->add_flag("--drop-statements", options->params.drop_statements, "with --force: drop the operator's statements too")
      ->needs(force);
  onRun(*command, session, [options, &session] { return build(*options, session); });
}

}  // namespace cluxel::app
