// SPDX-License-Identifier: Apache-2.0
// Finds the module beside the program or library that holds this code, and loads it once.
#include "scan/pcl/pcl_functions.hpp"

#include <dlfcn.h>

#include <filesystem>

#include "base/installation/own_binary.hpp"
#include "cluxel/error.hpp"

namespace cluxel::scan {

namespace {

const PclFunctions* loadedFunctions() {
  const std::filesystem::path module = ownModule("cluxel_pcl.so");
  void* library = dlopen(module.c_str(), RTLD_NOW | RTLD_LOCAL);  // stays loaded until the process ends
  void* entry = library == nullptr ? nullptr : dlsym(library, kPclEntryName);
  if (entry == nullptr) {
    const char* reason = dlerror();
    throw Error(ErrorKind::FaultyInput,
                "'" + module.string() + "', which reads and aligns clouds by PCL, cannot be loaded: " +
                    (reason == nullptr ? "unknown reason" : reason) + "; install PCL's libraries, or Cluxel anew");
  }
  return reinterpret_cast<PclEntry>(entry)();
}

}  // namespace

const PclFunctions& pcl() {
  static const PclFunctions* const functions = loadedFunctions();
  return *functions;
}

}  // namespace cluxel::scan
