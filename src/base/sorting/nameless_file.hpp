// SPDX-License-Identifier: Apache-2.0
// A temporary file that nobody can find: it is gone when it is closed, also when the process is killed.
#pragma once

#include <filesystem>

namespace cluxel {

/// The descriptor of a new file in `folder`, or -1 with errno. Where the file system has no files without a name, the
/// name is removed at once. Never one of the descriptors 0 to 2, which others may take for stdin, stdout and stderr.
int openNamelessFile(const std::filesystem::path& folder);

}  // namespace cluxel
