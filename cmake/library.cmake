# SPDX-License-Identifier: Apache-2.0
# libcluxel.so: the facade and all that it needs of the modules, which stay hidden in it.
add_library(cluxel_library SHARED $<TARGET_OBJECTS:cluxel_api>)
add_library(cluxel::cluxel ALIAS cluxel_library)
target_link_libraries(cluxel_library PRIVATE cluxel_tasks)
target_include_directories(cluxel_library INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_compile_features(cluxel_library INTERFACE cxx_std_20)
set_target_properties(cluxel_library PROPERTIES OUTPUT_NAME cluxel EXPORT_NAME cluxel LINKER_LANGUAGE CXX
  VERSION ${PROJECT_VERSION} SOVERSION 0 LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/libcluxel.map)
# The modules hide their own symbols; the script hides the templates of other libraries that they instantiate.
target_link_options(cluxel_library PRIVATE LINKER:--version-script=${PROJECT_SOURCE_DIR}/cmake/libcluxel.map)
if(NOT CLUXEL_SANITIZE)   # the sanitizers' runtime is linked into programs only
  target_link_options(cluxel_library PRIVATE LINKER:--no-undefined)
endif()
