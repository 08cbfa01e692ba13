# SPDX-License-Identifier: Apache-2.0
# Builds the documentation site into OUT: every warning of Sphinx or Doxygen and every dead link is an error.
find_program(doxygen doxygen)
if(NOT EXISTS ${PYTHON} OR NOT doxygen)
  message("skipped: `./x site` makes the environment that this needs, and installs Doxygen")
  return()
endif()
file(REMOVE_RECURSE ${OUT})
execute_process(COMMAND ${CMAKE_COMMAND} -E env PYTHONPATH=${PACKAGE} ${PYTHON} -m sphinx -q -W --keep-going -b html
                        -c docs/site . ${OUT}
                WORKING_DIRECTORY ${SOURCE} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${PYTHON} -B tests/guard/site_pages.py ${OUT}
                WORKING_DIRECTORY ${SOURCE} COMMAND_ERROR_IS_FATAL ANY)

# What users look for in the C++ reference is there, with its comment: page, words.
function(shown page words)
  file(READ ${OUT}/cpp/${page}.html text)
  string(FIND "${text}" "${words}" found)
  if(found EQUAL -1)
    message(FATAL_ERROR "${OUT}/cpp/${page}.html does not say: ${words}")
  endif()
endfunction()
shown(classreflectree_1_1ExactSampler "whatever the errors of any integral")
shown(structreflectree_1_1BrdfTraits "false: called from one thread")
shown(conceptreflectree_1_1Brdf "is anything callable: f(wo, wi)")
shown(namespacereflectree "or hides lobes that even a second look does not resolve")
shown(namespacereflectree "integrated by a cubature that shares no code with the builder")
shown(namespacereflectree "Where one fails, hypotheses are tried")
