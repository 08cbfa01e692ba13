# SPDX-License-Identifier: Apache-2.0
# cmake --install: headers, one exported library per room, the program, and packages for find_package and
# pkg-config.
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

# For pkg-config: reflectree-<room>.pc. Our libraries are static, so whatever a room needs stands in Requires and
# Libs. Places are relative to the file, so that an installation may be moved.
set(pkgconfig_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
cmake_path(ABSOLUTE_PATH pkgconfig_dir BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX} OUTPUT_VARIABLE pkgconfig_place)
foreach(kind INCLUDEDIR LIBDIR)
  cmake_path(ABSOLUTE_PATH CMAKE_INSTALL_${kind} BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX} OUTPUT_VARIABLE place)
  cmake_path(RELATIVE_PATH place BASE_DIRECTORY ${pkgconfig_place} OUTPUT_VARIABLE PC_${kind})
endforeach()
foreach(PC_ROOM IN LISTS REFLECTREE_BUILT_ROOMS)
  get_property(rooms GLOBAL PROPERTY REFLECTREE_${PC_ROOM}_USES)
  get_property(foreign GLOBAL PROPERTY REFLECTREE_${PC_ROOM}_PKGCONFIG)
  set(PC_LIBS ${foreign})
  list(FILTER PC_LIBS INCLUDE REGEX "^-l")
  list(FILTER foreign EXCLUDE REGEX "^-l")
  get_target_property(type reflectree_${PC_ROOM} TYPE)
  if(type STREQUAL "STATIC_LIBRARY")
    list(PREPEND PC_LIBS "-L\${libdir}" -lreflectree_${PC_ROOM})
  endif()
  list(TRANSFORM rooms PREPEND "reflectree-")
  list(TRANSFORM rooms APPEND " = ${PROJECT_VERSION}")
  list(JOIN PC_LIBS " " PC_LIBS)
  list(APPEND rooms ${foreign})
  list(JOIN rooms ", " PC_REQUIRES)
  configure_file(cmake/reflectree-room.pc.in ${PROJECT_BINARY_DIR}/pkgconfig/reflectree-${PC_ROOM}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/pkgconfig/reflectree-${PC_ROOM}.pc DESTINATION ${pkgconfig_dir})
endforeach()
