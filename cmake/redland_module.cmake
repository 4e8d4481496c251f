# SPDX-License-Identifier: Apache-2.0
# The storage module that stock Redland tools load through REDLAND_MODULE_PATH.
add_library(librdf_storage_cluxel MODULE ${PROJECT_SOURCE_DIR}/src/redland_module/librdf_storage_cluxel.cpp)
target_link_libraries(librdf_storage_cluxel PRIVATE cluxel_rdf)
set_target_properties(librdf_storage_cluxel PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
  LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/redland)
