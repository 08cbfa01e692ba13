# SPDX-License-Identifier: Apache-2.0
# Builds the documentation site into OUT: every warning of Sphinx and every dead link is an error.
if(NOT EXISTS ${PYTHON})
  message("skipped: `./x site` makes the environment that this needs")
  return()
endif()
file(REMOVE_RECURSE ${OUT})
execute_process(COMMAND ${CMAKE_COMMAND} -E env PYTHONPATH=${PACKAGE} ${PYTHON} -m sphinx -q -W --keep-going -b html
                        -c docs/site . ${OUT}
                WORKING_DIRECTORY ${SOURCE} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${PYTHON} -B tests/guard/site_pages.py ${OUT}
                WORKING_DIRECTORY ${SOURCE} COMMAND_ERROR_IS_FATAL ANY)
