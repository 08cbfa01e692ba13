# SPDX-License-Identifier: Apache-2.0
# cmake --install: headers, one exported library a room, the program, and a package for find_package.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/reflectree)

get_property(REFLECTREE_BUILT_ROOMS GLOBAL PROPERTY REFLECTREE_BUILT_ROOMS)
set(REFLECTREE_ROOM_FACTS "")
foreach(room IN LISTS REFLECTREE_BUILT_ROOMS)
  install(TARGETS reflectree_${room} EXPORT reflectree_${room})
  install(EXPORT reflectree_${room} FILE reflectree-${room}.cmake NAMESPACE reflectree:: DESTINATION ${package_dir})
  foreach(fact USES PACKAGES)
    get_property(values GLOBAL PROPERTY REFLECTREE_${room}_${fact})
    string(APPEND REFLECTREE_ROOM_FACTS "set(reflectree_${room}_${fact}")
    foreach(value IN LISTS values)  # one may hold blanks: "embree 3 CONFIG"
      string(APPEND REFLECTREE_ROOM_FACTS " \"${value}\"")
    endforeach()
    string(APPEND REFLECTREE_ROOM_FACTS ")\n")
  endforeach()
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/reflectree DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(TARGET reflectree)
  install(TARGETS reflectree)
endif()

configure_package_config_file(cmake/reflectree-config.cmake.in ${PROJECT_BINARY_DIR}/reflectree-config.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/reflectree-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/reflectree-config.cmake ${PROJECT_BINARY_DIR}/reflectree-config-version.cmake
        DESTINATION ${package_dir})
