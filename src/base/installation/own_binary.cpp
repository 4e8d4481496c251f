// SPDX-License-Identifier: Apache-2.0
// Modules lie below the folder of the binary or one of the two above it, so that all may be moved together.
#include "base/installation/own_binary.hpp"

#include <dlfcn.h>
#include <sys/auxv.h>
#include <sys/stat.h>

#include <array>

#include "cluxel/error.hpp"

namespace cluxel {

namespace fs = std::filesystem;

namespace {

/// A module is trusted when root owns it, or the owner of the binary.
bool isTrusted(const fs::path& module, const fs::path& binary) {
  struct ::stat of_module = {}, of_binary = {};
  if (stat(module.c_str(), &of_module) != 0 || stat(binary.c_str(), &of_binary) != 0) return false;
  return of_module.st_uid == 0 || of_module.st_uid == of_binary.st_uid;
}

}  // namespace

/// The loader's name of the program may be relative to a working directory that has changed since, so /proc is asked
/// instead.
fs::path ownBinary() {
  Dl_info own{}, program{};
  std::error_code ignored;
  const auto* entry = reinterpret_cast<const void*>(getauxval(AT_ENTRY));
  const bool is_known = dladdr(reinterpret_cast<const void*>(&ownBinary), &own) != 0;
  const bool is_library = is_known && dladdr(entry, &program) != 0 && own.dli_fbase != program.dli_fbase;
  return fs::canonical(is_library ? fs::path(own.dli_fname) : fs::path("/proc/self/exe"), ignored);
}

fs::path moduleOf(const fs::path& binary, const std::string& name) {
  constexpr int kMaxDepth = 3;  // prefix/lib/<architecture>/, build/tests/fuzz/
  const std::array folders{fs::path(CLUXEL_LIBRARY_FOLDER) / "cluxel", fs::path("modules")};
  fs::path above = binary.parent_path();
  for (int depth = 0; depth < kMaxDepth && above.has_relative_path(); ++depth, above = above.parent_path())
    for (const fs::path& folder : folders) {
      std::error_code ignored;
      const fs::path module = above / folder / name;
      if (!fs::exists(module, ignored)) continue;
      if (isTrusted(module, binary)) return module;
      throw Error(ErrorKind::FaultyInput, "'" + module.string() + "' is not loaded: it belongs to another user than '" +
                                              binary.string() + "'; install Cluxel anew");
    }
  throw Error(ErrorKind::FaultyInput,
              "'" + name + "' was not found around '" + binary.string() +
                  "'; the program stays in its installation or build folder: install Cluxel anew, "
                  "or link to the program instead of copying it");
}

fs::path ownModule(const std::string& name) {
  return moduleOf(ownBinary(), name);
}

}  // namespace cluxel
