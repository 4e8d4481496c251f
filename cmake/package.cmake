# SPDX-License-Identifier: Apache-2.0
# CPack makes Debian packages of the components of cmake/install.cmake; `./run package` calls it.
set(CLUXEL_MAINTAINER "The Cluxel authors <authors@cluxel.invalid>" CACHE STRING "Maintainer of the packages: NAME <ADDRESS>")
find_program(CLUXEL_DPKG_DEB dpkg-deb)
if(NOT CLUXEL_DPKG_DEB OR NOT CLUXEL_GZIP)
  return()
endif()

# What Debian asks of each package beside its files. Components named debian_* are in packages only, not in `cmake --install`.
set(debian_folder ${PROJECT_BINARY_DIR}/debian)
configure_file(${CMAKE_CURRENT_LIST_DIR}/debian/changelog.in ${debian_folder}/changelog.Debian @ONLY)
configure_file(CHANGELOG.md ${debian_folder}/changelog COPYONLY)
foreach(file changelog.Debian changelog)
  execute_process(COMMAND ${CLUXEL_GZIP} -9nkf ${debian_folder}/${file} COMMAND_ERROR_IS_FATAL ANY)
endforeach()

# cluxel_package(COMPONENT NAME SECTION SYNOPSIS TEXT [DEPENDS text]): the package NAME of the components COMPONENT and
# debian_COMPONENT.
macro(cluxel_package component name section synopsis text)
  cmake_parse_arguments(PACKAGE "" "DEPENDS" "" ${ARGN})
  install(FILES cmake/debian/copyright ${debian_folder}/changelog.Debian.gz ${debian_folder}/changelog.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT debian_${component} EXCLUDE_FROM_ALL)
  string(TOUPPER ${component} group)
  set(CPACK_COMPONENT_${group}_GROUP ${component})
  set(CPACK_COMPONENT_DEBIAN_${group}_GROUP ${component})
  list(APPEND CPACK_COMPONENTS_ALL ${component} debian_${component})
  set(CPACK_DEBIAN_${group}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${group}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${group}_PACKAGE_DEPENDS "${PACKAGE_DEPENDS}")
  set(CPACK_DEBIAN_${group}_DESCRIPTION "${synopsis}\n${text}")
endmacro()
set(CPACK_COMPONENTS_ALL)
set(same_version "(= ${CLUXEL_DEBIAN_VERSION})")
set(what_it_is "Cluxel turns registered laser scans of streets, parks and campuses into a
semantic map: objects with classes, parts, positions, relations and reasons,
which are asked in SPARQL.")

cluxel_package(program cluxel science "semantic maps of laser scans"
  "${what_it_is}\n.\nThis package holds the program and a storage module for the Redland RDF tools."
  DEPENDS "cluxel-data ${same_version}, libcluxel0 ${same_version}")
cluxel_package(data cluxel-data science "semantic maps of laser scans - rules and models"
  "${what_it_is}\n.\nThis package holds the ontology, rules, questions, label maps and trained\nmodels.")
cluxel_package(library libcluxel0 libs "semantic maps of laser scans - library"
  "${what_it_is}\n.\nThis package holds the shared library, and the module that uses PCL." DEPENDS "cluxel-data ${same_version}")
cluxel_package(development libcluxel-dev libdevel "semantic maps of laser scans - headers"
  "${what_it_is}\n.\nThis package holds the C++20 headers, the CMake package and an example."
  DEPENDS "libcluxel0 ${same_version}")
list(APPEND CPACK_COMPONENTS_ALL redland)
set(CPACK_COMPONENT_REDLAND_GROUP program)
set(CPACK_DEBIAN_DATA_PACKAGE_ARCHITECTURE all)
# The loader's cache is renewed by a trigger. The override names what CPack writes beside it.
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/debian/triggers)
install(FILES cmake/debian/libcluxel0.lintian-overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides RENAME libcluxel0
  COMPONENT debian_library EXCLUDE_FROM_ALL)
install(DIRECTORY examples/cpp DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libcluxel-dev/examples
  COMPONENT debian_development EXCLUDE_FROM_ALL)
install(FILES ${PROJECT_BINARY_DIR}/documentation/_cluxel DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions
  COMPONENT debian_program EXCLUDE_FROM_ALL)
if(TARGET cluxel_python)
  math(EXPR next_minor "${Python3_VERSION_MINOR} + 1")
  cluxel_package(python python3-cluxel python "semantic maps of laser scans - Python module"
    "${what_it_is}\n.\nThis package holds the Python module and examples."
    DEPENDS "libcluxel0 ${same_version}, python3 (>= ${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}~), \
python3 (<< ${Python3_VERSION_MAJOR}.${next_minor}), python3-numpy")
  install(DIRECTORY examples/python/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-cluxel/examples
    COMPONENT debian_python EXCLUDE_FROM_ALL FILES_MATCHING PATTERN "*.py")
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_PACKAGE_NAME cluxel)
set(CPACK_PACKAGE_CONTACT "${CLUXEL_MAINTAINER}")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SOURCE cluxel)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)   # an interface that may change with each version: equal versions only
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})   # libcluxel.so for the Python module
include(CPack)
