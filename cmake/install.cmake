# SPDX-License-Identifier: Apache-2.0
# cmake --install, by component: program, library, development, data, redland. The installed tree may be moved.
include(CMakePackageConfigHelpers)

install(TARGETS cluxel RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
install(TARGETS cluxel_library EXPORT cluxel
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development)
install(DIRECTORY include/cluxel DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development
  FILES_MATCHING PATTERN "*.hpp")
install(DIRECTORY ontology rules queries models labels DESTINATION ${CMAKE_INSTALL_DATADIR}/cluxel COMPONENT data)
# The page of `cluxel view`, where `./run web` has made it.
install(FILES web/dist/page.html DESTINATION ${CMAKE_INSTALL_DATADIR}/cluxel/web/dist COMPONENT data OPTIONAL)
# The module that scan::pcl() loads, for the program and the library.
install(TARGETS cluxel_pcl_module LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/cluxel COMPONENT library)
# For stock Redland tools: REDLAND_MODULE_PATH names this folder.
install(TARGETS librdf_storage_cluxel LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/cluxel/redland COMPONENT redland)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/cluxel)
install(EXPORT cluxel NAMESPACE cluxel:: FILE cluxelTargets.cmake DESTINATION ${package_folder} COMPONENT development)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/cluxelConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES cmake/cluxelConfig.cmake ${PROJECT_BINARY_DIR}/cluxelConfigVersion.cmake
  DESTINATION ${package_folder} COMPONENT development)
