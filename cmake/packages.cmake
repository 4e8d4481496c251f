# SPDX-License-Identifier: Apache-2.0
# Finds Debian's packages; `./run` installs them.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(OpenSSL REQUIRED)
find_package(ZLIB REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(ICU REQUIRED COMPONENTS uc i18n)
find_package(Boost REQUIRED)
if(CLUXEL_SIMULATION)
  find_package(embree 3 REQUIRED)
endif()
pkg_check_modules(YAMLCPP REQUIRED IMPORTED_TARGET yaml-cpp)
pkg_check_modules(REDLAND REQUIRED IMPORTED_TARGET redland)
pkg_check_modules(RAPTOR REQUIRED IMPORTED_TARGET raptor2)
pkg_check_modules(PROJ REQUIRED IMPORTED_TARGET proj)
pkg_check_modules(PCRE2 REQUIRED IMPORTED_TARGET libpcre2-8)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(HTTPLIB REQUIRED IMPORTED_TARGET cpp-httplib)
pkg_check_modules(LBFGS IMPORTED_TARGET liblbfgs)
pkg_check_modules(LMDB IMPORTED_TARGET lmdb)

# Debian ships these two without a pkg-config file in some releases.
foreach(pair "LBFGS;lbfgs" "LMDB;lmdb")
  list(GET pair 0 prefix)
  list(GET pair 1 library)
  if(NOT TARGET PkgConfig::${prefix})
    find_library(${prefix}_PATH ${library} REQUIRED)
    add_library(PkgConfig::${prefix} INTERFACE IMPORTED)
    target_link_libraries(PkgConfig::${prefix} INTERFACE ${${prefix}_PATH})
  endif()
endforeach()

# PCL for reading, writing and registering clouds: only the module scan sees its headers.
find_package(PCL REQUIRED COMPONENTS common io kdtree search registration)
# FLANN comes with PCL; its header needs LZ4 to save an index, which nothing does.
find_library(CLUXEL_LZ4 lz4 REQUIRED)
add_library(cluxel_pcl INTERFACE)
target_include_directories(cluxel_pcl SYSTEM INTERFACE ${PCL_INCLUDE_DIRS})
target_link_libraries(cluxel_pcl INTERFACE ${PCL_COMMON_LIBRARIES} ${PCL_IO_LIBRARIES} ${PCL_KDTREE_LIBRARIES}
  ${PCL_SEARCH_LIBRARIES} ${PCL_REGISTRATION_LIBRARIES} ${CLUXEL_LZ4})
