// SPDX-License-Identifier: Apache-2.0
// Each thread knows the writing calls whose callbacks it is running.
#include "api/guarded_call.hpp"

namespace cluxel {

namespace fs = std::filesystem;

namespace {

/// A callback that this thread is running, within the one that runs it.
struct RunningCallback {
  const WritingCall* call;
  const RunningCallback* outer;
};
thread_local const RunningCallback* innermost_callback = nullptr;

fs::path withoutLinksOf(const fs::path& file) {
  std::error_code ignored;
  const fs::path absolute = fs::absolute(file, ignored);
  const fs::path plain = fs::weakly_canonical(absolute, ignored);
  return plain.empty() ? absolute : plain;
}

}  // namespace

void requirePath(const fs::path& path, const char* what) {
  if (path.empty()) throw Error(ErrorKind::InvalidArgument, std::string(what) + ": the path is empty; name a file");
}

WritingCall::WritingCall(const fs::path& file, ProgressSink& caller) : file_(withoutLinksOf(file)), caller_(caller) {
  for (const RunningCallback* running = innermost_callback; running != nullptr; running = running->outer)
    if (running->call->file() == file_)
      throw Error(ErrorKind::InvalidArgument,
                  file.string() +
                      ": a callback of a call that writes this map cannot write it too. Callbacks may read "
                      "the map; write it when the call has ended");
}

bool WritingCall::isInCallback() {
  return innermost_callback != nullptr;
}

template <typename Callback>
void WritingCall::run(const Callback& callback) {
  struct Running {
    explicit Running(const WritingCall& call) : here{&call, innermost_callback} { innermost_callback = &here; }
    ~Running() { innermost_callback = here.outer; }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;
    RunningCallback here;
  };
  const Running running(*this);
  try {
    callback();
  } catch (...) {
    has_thrown_ = true;
    throw;
  }
}

void WritingCall::progress(std::string_view stage, std::size_t done, std::size_t total) {
  run([&] { caller_.progress(stage, done, total); });
}

void WritingCall::note(std::string_view message) {
  run([&] { caller_.note(message); });
}

void WritingCall::poll(const std::function<void()>& callback) {
  run(callback);
}

void throwAsError(const fs::filesystem_error& error) {
  if (error.path1().empty()) throw Error(ErrorKind::StoreUnavailable, error.what());
  throw Error(ErrorKind::StoreUnavailable, error.path1().string() + ": cannot be used: " + error.code().message());
}

}  // namespace cluxel
