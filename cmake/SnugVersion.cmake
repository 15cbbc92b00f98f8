# snug_version_header(target): a header version_text.hpp with the version and, in a git checkout, the commit; looked up at each build, written
# only when it has changed. As a script (cmake -P) it writes that header.
if(CMAKE_SCRIPT_MODE_FILE)
  cmake_policy(VERSION 3.25)
  set(text "${VERSION}")
  find_program(GIT git)
  if(GIT)
    execute_process(COMMAND ${GIT} -C ${SOURCE} describe --always --dirty --abbrev=9 --match=nothing
                    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE status)
    if(status EQUAL 0 AND commit)
      string(APPEND text " (${commit})")
    endif()
  endif()
  file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "// Version: written at each build by cmake/SnugVersion.cmake.
#pragma once
#define SNUG_VERSION \"@text@\"
" @ONLY)
  return()
endif()

function(snug_version_header target)
  set(folder ${PROJECT_BINARY_DIR}/generated)
  add_custom_target(${target}_version
    COMMAND ${CMAKE_COMMAND} -DVERSION=${PROJECT_VERSION} -DSOURCE=${PROJECT_SOURCE_DIR} -DOUTPUT=${folder}/version_text.hpp
            -P ${CMAKE_CURRENT_FUNCTION_LIST_FILE}
    BYPRODUCTS ${folder}/version_text.hpp
    COMMENT "" VERBATIM)
  add_dependencies(${target} ${target}_version)
  target_include_directories(${target} PRIVATE ${folder})
endfunction()
