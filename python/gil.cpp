// SPDX-License-Identifier: Apache-2.0
// A thread that Python ends is stopped where it asks for the GIL.
#include "gil.hpp"

#include <chrono>
#include <thread>

namespace cluxel::python {

namespace {

template <typename Take>
auto takenBy(const Take& take) noexcept {
  try {
    return take();
  } catch (const abi::__forced_unwind&) {
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
  }
}

}  // namespace

void takeGil(PyThreadState* state) noexcept {
  takenBy([state] { PyEval_RestoreThread(state); });
}

PyGILState_STATE takeGil() noexcept {
  return takenBy([] { return PyGILState_Ensure(); });
}

}  // namespace cluxel::python
