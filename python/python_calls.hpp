// SPDX-License-Identifier: Apache-2.0
// Calls from the library back into Python: progress, notes, and the check for Ctrl-C.
#pragma once

#include <chrono>
#include <exception>

#include "bindings.hpp"

namespace cluxel::python {

/// Hands progress and notes to Python functions (None: nobody) and checks for signals. The library calls it without
/// the GIL, from any thread. The first exception of Python ends the build: it is thrown again at each later call.
class PythonSink : public ProgressSink {
 public:
  PythonSink(py::object progress, py::object note) : progress_(std::move(progress)), note_(std::move(note)) {}
  void progress(std::string_view stage, std::size_t done, std::size_t total) override;
  void note(std::string_view message) override;

 private:
  template <typename Call>
  void guarded(const Call& call);

  py::object progress_, note_;
  std::exception_ptr failure_;
};

/// Raises KeyboardInterrupt in a long call. Looks at signals every 50 ms at most, because that takes the GIL.
class SignalPoll {
 public:
  void operator()();

 private:
  std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now();
};

}  // namespace cluxel::python
