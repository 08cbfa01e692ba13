# SPDX-License-Identifier: Apache-2.0
# What `pip install` builds. The core needs nothing. The judges need the headers of Boost and Eigen, and nothing
# when they run: they are built where both are found. The studio needs shared libraries of 49 MB: it is built
# where it is asked for, by `-C cmake.define.REFLECTREE_PYTHON_STUDIO=ON`.
option(REFLECTREE_PYTHON_STUDIO "Build the studio of the Python package: render, compare, pages" OFF)
set(default_rooms ${core_rooms})
find_package(Boost QUIET)
find_package(Eigen3 QUIET)
if(REFLECTREE_PYTHON_STUDIO)
  list(APPEND default_rooms ${rim_rooms})
elseif(Boost_FOUND AND Eigen3_FOUND)
  list(APPEND default_rooms verify peers)
else()
  message(STATUS "reflectree: no headers of Boost and Eigen, so that rt.verify and rt.doctor will be missing")
endif()
