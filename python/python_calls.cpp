// SPDX-License-Identifier: Apache-2.0
// Takes the GIL for each call, and keeps what Python raised.
#include "python_calls.hpp"

#include "gil.hpp"

namespace cluxel::python {

namespace {

void raiseSignals() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace

template <typename Call>
void PythonSink::guarded(const Call& call) {
  if (failure_) std::rethrow_exception(failure_);
  const HeldGil gil;
  try {
    raiseSignals();
    call();
  } catch (...) {
    failure_ = std::current_exception();
    throw;
  }
}

void PythonSink::progress(std::string_view stage, std::size_t done, std::size_t total) {
  guarded([&] {
    if (!progress_.is_none()) progress_(py::str(stage.data(), stage.size()), done, total);
  });
}

void PythonSink::note(std::string_view message) {
  guarded([&] {
    if (!note_.is_none()) note_(py::str(message.data(), message.size()));
  });
}

void SignalPoll::operator()() {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + std::chrono::milliseconds(50);
  const HeldGil gil;
  raiseSignals();
}

}  // namespace cluxel::python
