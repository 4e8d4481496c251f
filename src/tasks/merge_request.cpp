// SPDX-License-Identifier: Apache-2.0
// Finds the maps that options of a merge mean.
#include "tasks/merge_request.hpp"

#include "cluxel/error.hpp"

namespace cluxel::tasks {

namespace fs = std::filesystem;

void setTransform(std::vector<mapping::MapToMerge>& maps, const Eigen::Isometry3d& T_first_second) {
  if (maps.size() != 2)
    throw Error(ErrorKind::InvalidArgument, "a transform is for a merge of two maps: it takes the second to the first");
  maps.back().T_first_map = T_first_second;
  maps.back().has_transform = true;
}

std::size_t numberAmong(const std::vector<mapping::MapToMerge>& maps, const fs::path& file) {
  std::error_code ignored;
  for (std::size_t i = 0; i < maps.size(); ++i)
    if (maps[i].file == file || fs::equivalent(maps[i].file, file, ignored)) return i;
  throw Error(ErrorKind::InvalidArgument,
              file.string() + ": is not one of the maps that are merged; choose one of those");
}

}  // namespace cluxel::tasks
