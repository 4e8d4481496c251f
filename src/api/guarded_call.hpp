// SPDX-License-Identifier: Apache-2.0
// What surrounds the calls of the facade: which map a callback belongs to, and errors of the file system as Error.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <utility>

#include "cluxel/error.hpp"
#include "cluxel/progress.hpp"

namespace cluxel {

/// Throws Error (InvalidArgument) for an empty path; `what` says whose it is.
void requirePath(const std::filesystem::path& path, const char* what);

/// A call that writes a map, as the sink of its callbacks: hands all to the sink of the caller. A callback that writes
/// the same map would wait for the end of the call that waits for the callback, so it is refused.
class WritingCall : public ProgressSink {
 public:
  /// Throws Error (InvalidArgument) in a callback of another WritingCall of the same file.
  WritingCall(const std::filesystem::path& file, ProgressSink& caller);
  void progress(std::string_view stage, std::size_t done, std::size_t total) override;
  void note(std::string_view message) override;
  void poll(const std::function<void()>& callback);
  /// Whether the call was made in a callback of a call that writes another map.
  static bool isInCallback();
  /// Whether what ends the call comes from a callback.
  bool hasThrown() const { return has_thrown_; }
  const std::filesystem::path& file() const { return file_; }

 private:
  template <typename Callback>
  void run(const Callback& callback);

  std::filesystem::path file_;  ///< absolute, without links
  ProgressSink& caller_;
  std::atomic<bool> has_thrown_ = false;
};

/// An error of the file system as Error (StoreUnavailable) that names the path.
[[noreturn]] void throwAsError(const std::filesystem::filesystem_error& error);

/// Runs a call; errors of the file system become Error. What a callback of `writing` throws stays what it is.
template <typename Call>
auto guarded(const Call& call, const WritingCall* writing = nullptr) -> decltype(call()) {
  try {
    return call();
  } catch (const std::filesystem::filesystem_error& error) {
    if (writing && writing->hasThrown()) throw;
    throwAsError(error);
  }
}

}  // namespace cluxel
