// SPDX-License-Identifier: Apache-2.0
// Scans and folders that the user may not read: the message names them and says so.
#include <unistd.h>

#include "scan/scan_fixture.hpp"
#include "scan/scan_set.hpp"

namespace cluxel::scan {
namespace {

namespace fs = std::filesystem;

using test::refusalOf;
using test::ScratchFolder;
using testing::HasSubstr;

constexpr uid_t kNobody = 65534;

/// While it lives, this process has no more rights than any user.
class WithoutRights {
 public:
  WithoutRights() { EXPECT_EQ(::seteuid(user_ == 0 ? kNobody : user_), 0); }
  WithoutRights(const WithoutRights&) = delete;
  WithoutRights& operator=(const WithoutRights&) = delete;
  ~WithoutRights() { EXPECT_EQ(::seteuid(user_), 0); }

 private:
  uid_t user_ = ::geteuid();
};

class UnreadableInputs : public testing::Test {
 protected:
  UnreadableInputs() { fs::permissions(folder_.path(), fs::perms::all); }

  /// What is said of an input while it has no permissions but these.
  std::string refusal(const fs::path& locked, fs::perms permissions, const fs::path& input) const {
    fs::permissions(folder_.path() / locked, permissions);
    std::string text;
    {
      const WithoutRights rights;
      ProgressSink silent;
      text = refusalOf([&] { ScanSet::open({folder_.path() / input}, {}, silent); });
    }
    fs::permissions(folder_.path() / locked, fs::perms::all);
    return text;
  }

  ScratchFolder folder_;
};

TEST_F(UnreadableInputs, ScansCannotBeOpened) {
  const std::string inside = folder_.path().string() + "/";
  folder_.write("lone.pcd", "VERSION .7\nFIELDS x y z\n");
  folder_.write("lone.txt", "1 2 3\n");
  for (const char* name : {"lone.pcd", "lone.txt"})
    EXPECT_EQ(refusal(name, fs::perms::none, name), inside + name + ": error: cannot be opened: Permission denied");
}

TEST_F(UnreadableInputs, FoldersCannotBeRead) {
  const std::string inside = folder_.path().string() + "/";
  folder_.write("sealed/a.pcd", "VERSION .7\nFIELDS x y z\n");
  folder_.write("m.yaml", "scans: [sealed]\n");
  for (const fs::perms permissions : {fs::perms::none, fs::perms::owner_read | fs::perms::others_read}) {
    EXPECT_EQ(refusal("sealed", permissions, "sealed"),
              inside + "sealed: error: the folder cannot be read: Permission denied");
    EXPECT_EQ(refusal("sealed", permissions, "sealed/a.pcd"),
              inside + "sealed/a.pcd: error: cannot be opened: Permission denied");
    EXPECT_THAT(refusal("sealed", permissions, "m.yaml"),
                HasSubstr("m.yaml:1:9: error: " + inside + "sealed: the folder cannot be read: Permission denied"));
  }
}

}  // namespace
}  // namespace cluxel::scan
