# SPDX-License-Identifier: Apache-2.0
# find_package(cluxel CONFIG) gives the target cluxel::cluxel. It needs no other package.
include("${CMAKE_CURRENT_LIST_DIR}/cluxelTargets.cmake")
