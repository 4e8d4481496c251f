// SPDX-License-Identifier: Apache-2.0
// O_TMPFILE, or a name that is removed at once.
#include "base/sorting/nameless_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>

namespace cluxel {

namespace {

int openAny(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor >= 0) return descriptor;
  std::string name = folder / ".cluxel-temporary-XXXXXX";
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

}  // namespace

int openNamelessFile(const std::filesystem::path& folder) {
  constexpr int kFirst = 3;
  const int descriptor = openAny(folder);
  if (descriptor < 0 || descriptor >= kFirst) return descriptor;
  const int moved = ::fcntl(descriptor, F_DUPFD_CLOEXEC, kFirst);
  const int code = errno;
  ::close(descriptor);
  errno = code;
  return moved;
}

}  // namespace cluxel
