# SPDX-License-Identifier: Apache-2.0
# Writes OUT, which names the commit of SOURCE; left alone where that has not changed.
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND git describe --always --dirty WORKING_DIRECTORY ${SOURCE}
                OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit "unknown")
endif()
file(CONFIGURE OUTPUT ${OUT} @ONLY CONTENT "// SPDX-License-Identifier: Apache-2.0
namespace reflectree::cli {
const char* source_commit();
const char* source_commit() { return \"@commit@\"; }
}  // namespace reflectree::cli
")
