# SPDX-License-Identifier: Apache-2.0
# A room is a static library of the sources in its folder (or headers alone), with a folder in include/ and one
# in src/; the arrows between rooms are text, math <- brdf <- sampler <- formats <- everything else, kept by
# tests/guard/layers.py.
#
# reflectree_room(name [SOURCES a.cpp ...] USES reflectree::math ... PRIVATE PNG::PNG ... PACKAGES "embree 3" ...
#                 PKGCONFIG libpng -lembree3 ...)
# makes reflectree::name. A used target is called package::target; the installed package looks for exactly
# those packages, and for PACKAGES, when a consumer asks for the room. What is but headers, and seen by our
# sources alone, is $<BUILD_INTERFACE:...>: a consumer does not need it. PKGCONFIG names the same libraries for
# pkg-config: by their .pc file, or as -lname where they have none.
include(GNUInstallDirs)

function(reflectree_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;USES;PRIVATE;PACKAGES;PKGCONFIG" ${ARGN})
  set(target reflectree_${name})
  if(NOT ROOM_SOURCES)
    file(GLOB_RECURSE ROOM_SOURCES CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.cpp)
  endif()
  if(ROOM_SOURCES)
    set(public PUBLIC)
    add_library(${target} STATIC ${ROOM_SOURCES})
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:reflectree_options> ${ROOM_PRIVATE})
    target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})  # "folder/NAME.hpp" of the room itself
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)  # for plug-ins and Python
  else()
    set(public INTERFACE)
    add_library(${target} INTERFACE)
  endif()
  add_library(reflectree::${name} ALIAS ${target})
  target_compile_features(${target} ${public} cxx_std_20)
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} ${public}
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${target} ${public} ${ROOM_USES})

  set(rooms "")
  set(packages "${ROOM_PACKAGES}")
  foreach(used IN LISTS ROOM_USES ROOM_PRIVATE)
    if(used MATCHES "^reflectree(::|_)(.+)$")
      list(APPEND rooms ${CMAKE_MATCH_2})
    elseif(used MATCHES "^([A-Za-z0-9_]+)::")
      list(APPEND packages ${CMAKE_MATCH_1})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES packages)
  set_property(GLOBAL APPEND PROPERTY REFLECTREE_BUILT_ROOMS ${name})
  set_property(GLOBAL PROPERTY REFLECTREE_${name}_USES "${rooms}")
  set_property(GLOBAL PROPERTY REFLECTREE_${name}_PACKAGES "${packages}")
  set_property(GLOBAL PROPERTY REFLECTREE_${name}_PKGCONFIG "${ROOM_PKGCONFIG}")
endfunction()
