# SPDX-License-Identifier: Apache-2.0
# Configures, builds and runs tests/consumer against the library.
#   WAY       find_package (installs BUILD first); any other: add_subdirectory(SOURCE)
#   COMPILER  the C++ compiler    FLAGS  its flags    SCRATCH  a folder of ours
set(folder ${SCRATCH}/${WAY})

function(step)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${WAY}: `${ARGN}` ended with ${result}")
  endif()
endfunction()

set(options "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DCMAKE_CXX_FLAGS=${FLAGS} -O1" -DCMAKE_BUILD_TYPE=None)
if(WAY STREQUAL "find_package")
  file(REMOVE_RECURSE ${folder})
  step(${CMAKE_COMMAND} --install ${BUILD} --prefix ${folder}/prefix)
  list(APPEND options "-DCMAKE_PREFIX_PATH=${folder}/prefix")
else()
  list(APPEND options "-DREFLECTREE_SOURCE=${SOURCE}" -DREFLECTREE_WERROR=ON)
endif()
find_program(ccache ccache)
if(ccache)
  list(APPEND options "-DCMAKE_CXX_COMPILER_LAUNCHER=${ccache}")
endif()
step(${CMAKE_COMMAND} -G Ninja -S ${SOURCE}/tests/consumer -B ${folder}/build ${options})
step(${CMAKE_COMMAND} --build ${folder}/build --parallel 2)
step(${folder}/build/consumer)
