# SPDX-License-Identifier: Apache-2.0
# Modules that stock Redland tools load through REDLAND_MODULE_PATH: one shared object per src/redland_modules/*.cpp.
file(GLOB module_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/redland_modules/*.cpp)
foreach(source ${module_sources})
  get_filename_component(module ${source} NAME_WE)
  add_library(${module} MODULE ${source})
  target_include_directories(${module} PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(${module} PRIVATE cluxel_sparql)
  set_target_properties(${module} PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/redland)
endforeach()
