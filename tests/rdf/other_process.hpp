// SPDX-License-Identifier: Apache-2.0
// Another process that works, waits in the middle, and goes on when the test tells it.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <exception>
#include <functional>
#include <utility>

namespace cluxel::rdf {

using Pause = std::function<void()>;

/// Another process, which does some work, waits when it calls its argument, and goes on when this object ends. Maps
/// that this process has open cannot be used there: the other process opens them again.
class OtherProcess {
 public:
  /// `work` gives the exit status.
  explicit OtherProcess(const std::function<int(const Pause&)>& work) {
    if ((::pipe(to_child_) | ::pipe(to_parent_)) != 0) std::abort();
    child_ = ::fork();
    if (child_ == 0) ::_exit(run(work));
    ::close(to_child_[0]);
    ::close(to_parent_[1]);
    char byte = 0;
    EXPECT_EQ(::read(to_parent_[0], &byte, 1), 1) << "the other process failed";
  }
  OtherProcess(const OtherProcess&) = delete;
  OtherProcess& operator=(const OtherProcess&) = delete;
  ~OtherProcess() { end(); }

  int end() {
    if (child_ == 0) return status_;
    ::close(to_child_[1]);
    ::close(to_parent_[0]);
    int status = 0;
    ::waitpid(std::exchange(child_, 0), &status, 0);
    return status_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  int run(const std::function<int(const Pause&)>& work) {
    ::alarm(60);
    ::close(to_child_[1]);
    ::close(to_parent_[0]);
    try {
      return work([this] {
        char byte = 'x';
        if (::write(to_parent_[1], &byte, 1) == 1) (void)!::read(to_child_[0], &byte, 1);
      });
    } catch (const std::exception&) {
      return 97;
    }
  }

  int to_child_[2]{}, to_parent_[2]{};
  pid_t child_ = 0;
  int status_ = -1;
};

}  // namespace cluxel::rdf
