// SPDX-License-Identifier: Apache-2.0
// A dry run needs no right to write the map, its folder, or the folder of the result.
#include <sys/stat.h>

#include <algorithm>

#include "base/file_bytes.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/map_merge.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/map_file_fixture.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

class NoteKeeper : public ProgressSink {
 public:
  void note(std::string_view message) override { notes.append(message).append("\n"); }
  std::string notes;
};

/// Maps of two scans and of the third one, in a folder that only root may write.
class DryRun : public MapFile {
 protected:
  DryRun() {
    const ScanSet scans = scansOf(campus_.files());
    const MapInputs inputs = shippedInputs();
    buildMap(scans.only({0, 1}), inputs, file_, {}, silence());
    buildMap(scans.only({2}), inputs, other_, {}, silence());
    for (std::size_t i = 0; i < scans.size(); ++i) ids_.push_back(scans.load(i).id);
    for (const fs::path& file : {file_, other_}) {
      fs::remove(file.string() + "-lock");
      ::chmod(file.c_str(), 0444);
    }
    ::chmod(campus_.files().front().parent_path().c_str(), 0755);
    ::chmod(folder_.path().c_str(), 0555);
  }
  ~DryRun() override { ::chmod(folder_.path().c_str(), 0755); }

  /// The exit status of `work` as a user who may not write the folder: root becomes another one.
  template <typename Work>
  static int asAnotherUser(const Work& work) {
    constexpr uid_t kNobody = 65534;
    return inChild([&] {
      if (::geteuid() == 0 && (::setgid(kNobody) != 0 || ::setuid(kNobody) != 0)) ::_exit(98);
      return work() ? 0 : 1;
    });
  }
  std::vector<std::string> namesInFolder() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_.path())) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }

  SmallCampus campus_{{.seed = 7, .stops = 3, .size_m = 45, .points_per_stop = 1200}};
  fs::path other_ = folder_.path() / "other.clx";
  std::vector<ScanId> ids_;
  ChangeParams params_{.dry_run = true};
};

TEST_F(DryRun, TellsWhatWouldChangeInAMapThatMayNotBeWritten) {
  const std::string before = readFile(file_);
  EXPECT_EQ(asAnotherUser([&] {
              NoteKeeper sink;
              const bool extends = extendMap(file_, scansOf({campus_.files()[2]}), params_, sink).scans_added == 1;
              return extends && sink.notes.find("the dry run works on a copy in") != std::string::npos;
            }),
            0);
  EXPECT_EQ(asAnotherUser([&] { return retractScans(file_, {ids_[1]}, params_, silence()).scans_removed == 1; }), 0);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  EXPECT_EQ(asAnotherUser([&] { return moveScans(file_, {{ids_[0], pose}}, params_, silence()).scans_moved == 1; }), 0);
  const auto without_sparql_rules = [](MapInputs inputs) {
    inputs.sparql_rules.clear();
    return inputs;
  };
  EXPECT_EQ(asAnotherUser([&] { return applyInputs(file_, without_sparql_rules, params_, silence()).has_changes; }), 0);
  EXPECT_TRUE(readFile(file_) == before);
  EXPECT_THAT(namesInFolder(), ElementsAre("map.clx", "other.clx"));
}

TEST_F(DryRun, TellsWhatAMergeIntoAFolderThatMayNotBeWrittenWouldGive) {
  EXPECT_EQ(asAnotherUser([&] {
              MergeParams params;
              params.change = params_;
              return mergeMaps({{file_}, {other_}}, folder_.path() / "merged.clx", params, silence()).scans == 3;
            }),
            0);
  EXPECT_THAT(namesInFolder(), ElementsAre("map.clx", "other.clx"));
}

TEST_F(DryRun, IsTheOnlyRunThatNeedsNoRightToWrite) {
  constexpr int kStoreUnavailable = 50 + static_cast<int>(ErrorKind::StoreUnavailable);
  EXPECT_EQ(asAnotherUser([&] { return retractScans(file_, {ids_[1]}, {}, silence()).scans_removed == 1; }),
            kStoreUnavailable);
}

}  // namespace
}  // namespace cluxel::mapping
