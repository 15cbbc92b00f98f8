# snug_module(name HEADERS ... SOURCES ... DEPENDS modules... LINK libraries... TESTS files... SLOW_TESTS files...)
#
# Makes the static library snug::<name> from the folder it is called in, checks that each public header compiles
# alone, and builds the module's tests. DEPENDS lists the modules it may include; tools/check_modules.py holds it to that.

# -Wno-restrict: g++ 12 reports impossible overlaps in std::string (GCC bug 105651).
set(SNUG_WARNINGS -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wno-restrict)
# Same input, same bytes: no fused multiply-add unless written, and no reordering of sums.
set(SNUG_CODEGEN -ffp-contract=off)

function(snug_compile_options target)
  target_compile_options(${target} PRIVATE ${SNUG_WARNINGS} ${SNUG_CODEGEN})
  if(SNUG_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

function(snug_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;LABELS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINK} GTest::gtest GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE SNUG_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  snug_compile_options(${name})
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
                       PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT 1200)
endfunction()

function(snug_module name)
  cmake_parse_arguments(ARG "" "" "HEADERS;SOURCES;DEPENDS;LINK;TESTS;SLOW_TESTS" ${ARGN})
  add_library(snug_${name} STATIC ${ARG_SOURCES})
  add_library(snug::${name} ALIAS snug_${name})
  target_sources(snug_${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${CMAKE_SOURCE_DIR}/src FILES ${ARG_HEADERS})
  set_target_properties(snug_${name} PROPERTIES VERIFY_INTERFACE_HEADER_SETS ON LINKER_LANGUAGE CXX)
  list(TRANSFORM ARG_DEPENDS PREPEND snug::)
  target_link_libraries(snug_${name} PUBLIC ${ARG_DEPENDS} Eigen3::Eigen PRIVATE ${ARG_LINK})
  snug_compile_options(snug_${name})
  if(SNUG_TESTS)
    add_custom_target(${name}_tests)  # what `make test MODULE=<name>` builds
  endif()
  if(SNUG_TESTS AND ARG_TESTS)
    snug_test(${name}_test SOURCES ${ARG_TESTS} LINK snug::${name} ${ARG_LINK} LABELS "${name}")
    add_dependencies(${name}_tests ${name}_test)
  endif()
  if(SNUG_TESTS AND ARG_SLOW_TESTS)
    snug_test(${name}_slow_test SOURCES ${ARG_SLOW_TESTS} LINK snug::${name} ${ARG_LINK} LABELS "${name};slow")
    add_dependencies(${name}_tests ${name}_slow_test)
  endif()
endfunction()
