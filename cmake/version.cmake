# SPDX-License-Identifier: Apache-2.0
# The commit that `cluxel --version` prints: CLUXEL_COMMIT when it is given, else git's at configure time, else "unknown".
set(CLUXEL_COMMIT "" CACHE STRING "Commit to print; empty: ask git")
set(commit "${CLUXEL_COMMIT}")
if(NOT commit AND EXISTS ${PROJECT_SOURCE_DIR}/.git)
  execute_process(COMMAND git rev-parse --short=12 HEAD WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(NOT commit)
  set(commit unknown)
endif()
set_property(SOURCE ${PROJECT_SOURCE_DIR}/src/app/version_text.cpp APPEND PROPERTY
  COMPILE_DEFINITIONS CLUXEL_COMMIT="${commit}")
