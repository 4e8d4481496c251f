// SPDX-License-Identifier: Apache-2.0
// A thread that Python ends is stopped where it asks for the GIL.
#include "gil.hpp"

#include <cxxabi.h>
#include <unistd.h>

namespace cluxel::python {

namespace {

template <typename Take>
auto takenBy(const Take& take) noexcept {
  try {
    return take();
  } catch (const abi::__forced_unwind&) {
    for (;;) pause();
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
