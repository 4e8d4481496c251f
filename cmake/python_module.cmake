# SPDX-License-Identifier: Apache-2.0
# The Python module: on when pybind11 and the headers of Python and NumPy are found. Off under sanitizers, whose runtime
# is linked into programs only.
set(python_default OFF)
if(NOT CLUXEL_SANITIZE)
  # The system's interpreter, for which Debian has NumPy and pytest; Python3_EXECUTABLE names another one.
  if(NOT DEFINED Python3_EXECUTABLE AND EXISTS /usr/bin/python3)
    set(Python3_EXECUTABLE /usr/bin/python3)
  endif()
  find_package(Python3 QUIET COMPONENTS Interpreter Development.Module)
  find_package(pybind11 2.10 CONFIG QUIET)
  if(Python3_FOUND AND pybind11_FOUND)
    set(python_default ON)
  endif()
endif()
option(CLUXEL_PYTHON "Build the Python module cluxel (needs pybind11)" ${python_default})
if(CLUXEL_PYTHON AND NOT pybind11_FOUND)
  message(FATAL_ERROR "CLUXEL_PYTHON needs pybind11 2.10 and Python's headers (Debian: pybind11-dev python3-dev), and no sanitizer")
endif()
if(CLUXEL_PYTHON)
  add_subdirectory(python)
endif()
