# SPDX-License-Identifier: Apache-2.0
# cluxel_module(NAME USES modules... LIBS libraries...): the static library of one module, from src/NAME/**/*.cpp.
# Headers of LIBS are private to the module: only the modules of USES are passed on.
function(cluxel_module name)
  cmake_parse_arguments(MODULE "" "" "USES;LIBS" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${name}/*.cpp)
  add_library(cluxel_${name} STATIC ${sources})
  target_include_directories(cluxel_${name} PUBLIC ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src)
  set_target_properties(cluxel_${name} PROPERTIES UNITY_BUILD ${CLUXEL_UNITY} UNITY_BUILD_BATCH_SIZE 12
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  list(TRANSFORM MODULE_USES PREPEND cluxel_)
  target_link_libraries(cluxel_${name} PUBLIC ${MODULE_USES} Eigen3::Eigen
    PRIVATE nlohmann_json::nlohmann_json ${MODULE_LIBS} ${CMAKE_DL_LIBS})
endfunction()
