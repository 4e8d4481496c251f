// SPDX-License-Identifier: Apache-2.0
// Giving up the GIL and taking it, also in threads that still run when the program ends.
#pragma once

#include <pybind11/pybind11.h>

namespace cluxel::python {

/// Takes the GIL for this thread. The interpreter of Python 3.11 ends a thread that asks for the GIL while the program
/// ends, by unwinding its stack; destructors and the library do not let that pass, so the program would abort. Such a
/// thread sleeps here instead, until the process is gone.
void takeGil(PyThreadState* state) noexcept;
PyGILState_STATE takeGil() noexcept;

/// The time in which other Python threads run.
class ReleasedGil {
 public:
  ReleasedGil() : state_(PyEval_SaveThread()) {}
  ~ReleasedGil() { takeGil(state_); }
  ReleasedGil(const ReleasedGil&) = delete;
  ReleasedGil& operator=(const ReleasedGil&) = delete;

 private:
  PyThreadState* state_;
};

/// The time in which a call of the library, in any thread, uses Python.
class HeldGil {
 public:
  HeldGil() : state_(takeGil()) {}
  ~HeldGil() { PyGILState_Release(state_); }
  HeldGil(const HeldGil&) = delete;
  HeldGil& operator=(const HeldGil&) = delete;

 private:
  PyGILState_STATE state_;
};

}  // namespace cluxel::python
