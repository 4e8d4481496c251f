// SPDX-License-Identifier: Apache-2.0
// How a command that runs until it is stopped notices that it should stop.
#pragma once

#include <chrono>
#include <csignal>
#include <ctime>

namespace cluxel::app {

/// SIGINT and SIGTERM, blocked in all threads that start later. When it is destroyed they act as before: a second
/// signal then ends the program at once.
class StopSignals {
 public:
  StopSignals() {
    sigemptyset(&set_);
    sigaddset(&set_, SIGINT);
    sigaddset(&set_, SIGTERM);
    ::pthread_sigmask(SIG_BLOCK, &set_, &before_);
  }
  ~StopSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  /// True when a signal has arrived or arrives within `wait`. Each signal is reported once.
  bool arrived(std::chrono::seconds wait = std::chrono::seconds(0)) const {
    const timespec limit{wait.count(), 0};
    return ::sigtimedwait(&set_, nullptr, &limit) > 0;
  }

 private:
  sigset_t set_{}, before_{};
};

}  // namespace cluxel::app
