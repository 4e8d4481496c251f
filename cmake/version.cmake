# SPDX-License-Identifier: Apache-2.0
# The commit that `cluxel --version` prints: CLUXEL_COMMIT when it is given, else git's at configure time, else "unknown".
# CLUXEL_DEBIAN_VERSION and CLUXEL_CHANGE_DATE are those of the packages; the date is the commit's.
set(CLUXEL_COMMIT "" CACHE STRING "Commit to print; empty: ask git")
set(CLUXEL_BUILT_COMMIT "${CLUXEL_COMMIT}")
if(EXISTS ${PROJECT_SOURCE_DIR}/.git)
  if(EXISTS ${PROJECT_SOURCE_DIR}/.git/logs/HEAD)   # a new commit configures anew
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/.git/logs/HEAD)
  endif()
  execute_process(COMMAND git log -1 --format=%h:%ct --abbrev=12 WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    OUTPUT_VARIABLE head OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(head MATCHES "^([0-9a-f]+):([0-9]+)$")
    set(head_commit ${CMAKE_MATCH_1})
    set(head_seconds ${CMAKE_MATCH_2})
    if(NOT CLUXEL_BUILT_COMMIT)
      set(CLUXEL_BUILT_COMMIT ${head_commit})
    endif()
    if(NOT DEFINED ENV{SOURCE_DATE_EPOCH})
      set(ENV{SOURCE_DATE_EPOCH} ${head_seconds})   # for this configuration only
    endif()
  endif()
endif()
if(NOT CLUXEL_BUILT_COMMIT)
  set(CLUXEL_BUILT_COMMIT unknown)
endif()
set(CLUXEL_DEBIAN_VERSION ${PROJECT_VERSION}-1)
string(TIMESTAMP CLUXEL_CHANGE_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
set_property(SOURCE ${PROJECT_SOURCE_DIR}/src/app/help/version_text.cpp APPEND PROPERTY
  COMPILE_DEFINITIONS CLUXEL_COMMIT="${CLUXEL_BUILT_COMMIT}")
