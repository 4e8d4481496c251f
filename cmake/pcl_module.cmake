# SPDX-License-Identifier: Apache-2.0
# The module that scan::pcl() loads: all code that uses PCL. Of Cluxel it links `base` alone.
file(GLOB pcl_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/pcl_module/*.cpp)
add_library(cluxel_pcl_module MODULE ${pcl_sources})
target_include_directories(cluxel_pcl_module PRIVATE ${PROJECT_SOURCE_DIR}/src)
target_link_libraries(cluxel_pcl_module PRIVATE cluxel_base cluxel_pcl Eigen3::Eigen)
set_target_properties(cluxel_pcl_module PROPERTIES OUTPUT_NAME cluxel_pcl PREFIX "" CXX_VISIBILITY_PRESET hidden
  VISIBILITY_INLINES_HIDDEN ON LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/modules)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")   # a false alarm within PCL's headers, about Eigen's loads of four floats
  set_source_files_properties(${PROJECT_SOURCE_DIR}/src/pcl_module/pcl_alignment.cpp PROPERTIES COMPILE_OPTIONS -Wno-array-bounds)
endif()
add_dependencies(cluxel_scan cluxel_pcl_module)   # built wherever it may be loaded
