# snug_module(name [COLD] [ALONE] HEADERS ... SOURCES ... COLD_SOURCES ... DEPENDS modules... LINK libraries... TESTS files...
#   SLOW_TESTS files... TEST_DEPENDS modules...)
#
# COLD says it of all sources, COLD_SOURCES of some: no run spends its time in them (see snug_compile_options).
# Makes the static library snug::<name> from the folder it is called in and builds the module's tests. DEPENDS lists the modules
# it may include, TEST_DEPENDS those that only its tests may; tools/check_modules.py holds it to that.
# Tests are no part of the target `all`: `make test` builds the target `tests`, `make test MODULE=<name>` `<name>_tests`.

include(SnugDependencies)

# -Wno-restrict: g++ 12 reports impossible overlaps in std::string (GCC bug 105651). -Wno-dangling-reference: g++ 13 takes any
# function with a temporary among its arguments for one that returns it (g++ 14 looks closer).
set(SNUG_WARNINGS -Wall -Wextra -Wpedantic -Wconversion -Wshadow)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND SNUG_WARNINGS -Wno-restrict)
  if(CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 13 AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 14)
    list(APPEND SNUG_WARNINGS -Wno-dangling-reference)
  endif()
endif()
# Warnings are errors only with compilers that portability.yml names: a newer one warns of things that nobody could know.
if(SNUG_WERROR AND NOT (CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 15) AND
   NOT (CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 20))
  message(STATUS "warnings of ${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} are not taken for errors")
  set(SNUG_WERROR OFF)
endif()
# Same input, same bytes: no fused multiply-add unless written, and no reordering of sums. File names in messages start at
# the project's folder, so that a program tells nothing of the machine that built it.
set(SNUG_CODEGEN -ffp-contract=off -fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
  list(APPEND SNUG_CODEGEN -I${PROJECT_SOURCE_DIR}/cmake/aarch64)
endif()
# An error in memory becomes an end of the program: canaries, stacks that are touched page by page, marked targets of jumps, checked
# copies, and tables of functions that nobody can write once the program runs (docs/dependencies.md says what is loaded).
# Libraries are found where the system has them: CMake would add the folder of each and an empty entry, which is the
# current folder of whoever starts the program.
set(CMAKE_SKIP_RPATH ON)
set(SNUG_HARDENING -fstack-protector-strong)
if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
  list(APPEND SNUG_HARDENING -fstack-clash-protection)
  add_link_options(-Wl,-z,relro,-z,now,-z,noexecstack,--as-needed)
endif()
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  list(APPEND SNUG_HARDENING -fcf-protection=full)
endif()
if(CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT SNUG_SANITIZE)
  list(APPEND SNUG_HARDENING -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2)
endif()
# The libraries go into the program and into the Python module: code that may stand anywhere and exports nothing has the speed of
# a program's.
set(SNUG_LIBRARY_CODEGEN -fPIC -fvisibility=hidden -fvisibility-inlines-hidden)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND SNUG_LIBRARY_CODEGEN -fno-semantic-interposition)
endif()

# Files compiled as one look to g++ like headers with unnamed namespaces. With precompiled headers g++ 12 forgets which code is
# the library's own and reports the same impossible sizes in std::string there; the preset dev, without them, has these
# warnings on.
set(SNUG_FAST_BUILD_WARNINGS -Wno-subobject-linkage -Wno-stringop-overflow -Wno-stringop-overread -Wno-array-bounds -Wno-maybe-uninitialized)

# snug_compile_options(target [LIBRARY] [COLD]): LIBRARY is what shares the libraries' precompiled headers. COLD is code in which
# no run spends its time (files read and written, words, tests): a fast build compiles it with -O1, a third of the work less.
function(snug_compile_options target)
  target_compile_options(${target} PRIVATE ${SNUG_WARNINGS} ${SNUG_CODEGEN} ${SNUG_HARDENING})
  if("LIBRARY" IN_LIST ARGN)
    target_compile_options(${target} PRIVATE ${SNUG_LIBRARY_CODEGEN})
  endif()
  if(SNUG_FAST_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE ${SNUG_FAST_BUILD_WARNINGS})
    if("COLD" IN_LIST ARGN AND CMAKE_BUILD_TYPE STREQUAL "Release")
      target_compile_options(${target} PRIVATE -O1)
    endif()
  endif()
  if(SNUG_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# Headers that most files read are compiled once: a third of the work of a build. What they hold is no promise to the files
# that use them: without (preset dev, the second compiler of .ci/run) each file gets what it includes and nothing else.
option(SNUG_FAST_BUILD "Precompile the headers that most files read, group files that share one" ${PROJECT_IS_TOP_LEVEL})
if(SNUG_FAST_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # g++ tidies its memory at every 128 MB or less, a seventh of its time with Eigen's templates: only from 0.5 GB on.
  add_compile_options(--param=ggc-min-expand=1000 --param=ggc-min-heapsize=524288)
endif()

# snug_precompile(set [LIBRARY] [COLD] HEADERS <...>... LINK libraries...): makes a set for snug_use_precompiled().
function(snug_precompile set)
  cmake_parse_arguments(ARG "LIBRARY;COLD" "" "HEADERS;LINK" ${ARGN})
  if(NOT SNUG_FAST_BUILD)
    return()
  endif()
  set(source ${PROJECT_BINARY_DIR}/precompiled/${set}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "// Needed to have a target: what counts is its precompiled header.\n")
  add_library(snug_precompiled_${set} OBJECT EXCLUDE_FROM_ALL ${source})
  target_include_directories(snug_precompiled_${set} PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(snug_precompiled_${set} PRIVATE ${ARG_LINK})
  snug_compile_options(snug_precompiled_${set} ${ARGN})
  target_precompile_headers(snug_precompiled_${set} PRIVATE ${ARG_HEADERS})
endfunction()

# The compiler demands the same options and definitions for a set and for its users (-Wpedantic, too, hides a feature of the
# language).
function(snug_use_precompiled target set)
  if(TARGET snug_precompiled_${set})
    target_precompile_headers(${target} REUSE_FROM snug_precompiled_${set})
    target_compile_definitions(${target} PRIVATE $<TARGET_PROPERTY:snug_precompiled_${set},COMPILE_DEFINITIONS>)
  endif()
endfunction()

snug_find_dependency(Eigen3::Eigen find_package REQUIRED)
set(SNUG_LIBRARY_HEADERS
    <snug/spatial/pose.hpp> <Eigen/Cholesky> <Eigen/Core> <Eigen/Geometry> <Eigen/LU>
    <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory> <mutex> <numbers>
    <optional> <set> <span> <sstream> <string> <string_view> <thread> <utility> <variant> <vector>)
set(SNUG_LIBRARY_LINK Eigen3::Eigen)
set(SNUG_COLD_HEADERS <fstream>)
set(SNUG_COLD_LINK)
if(SNUG_FAST_BUILD)
  # A project of few modules may have neither. JSON costs half a second where it is not used: cold code nearly always uses it.
  snug_find_dependency(fmt::fmt find_package QUIET)
  snug_find_dependency(nlohmann_json::nlohmann_json find_package QUIET)
  if(TARGET fmt::fmt)
    list(APPEND SNUG_LIBRARY_HEADERS <fmt/format.h>)
    list(APPEND SNUG_LIBRARY_LINK fmt::fmt)
  endif()
  if(TARGET nlohmann_json::nlohmann_json)
    list(APPEND SNUG_COLD_HEADERS <nlohmann/json.hpp>)
    list(APPEND SNUG_COLD_LINK nlohmann_json::nlohmann_json)
  endif()
endif()
snug_precompile(library LIBRARY LINK ${SNUG_LIBRARY_LINK} HEADERS ${SNUG_LIBRARY_HEADERS})
snug_precompile(cold_library LIBRARY COLD LINK ${SNUG_LIBRARY_LINK} ${SNUG_COLD_LINK} HEADERS ${SNUG_LIBRARY_HEADERS} ${SNUG_COLD_HEADERS})

if(SNUG_TESTS)
  add_custom_target(snug_tests)  # what `make test` builds
  snug_precompile(test COLD LINK Eigen3::Eigen GTest::gtest
    HEADERS <gtest/gtest.h> <snug/spatial/pose.hpp> <Eigen/Core> <Eigen/Geometry> <Eigen/LU>
            <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <limits> <memory> <numbers> <optional>
            <span> <sstream> <string> <string_view> <utility> <variant> <vector>)
endif()

function(snug_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;LABELS" ${ARGN})
  add_executable(${name} EXCLUDE_FROM_ALL ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINK} GTest::gtest GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE SNUG_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  snug_compile_options(${name} COLD)
  snug_use_precompiled(${name} test)
  if(SNUG_FAST_BUILD)
    set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 12)
    list(FILTER ARG_SOURCES INCLUDE REGEX "allocation_[a-z]+.cpp$")  # these replace operator new or malloc
    set_source_files_properties(${ARG_SOURCES} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
  add_dependencies(snug_tests ${name})
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
                       PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT 1200)
endfunction()

# Adds a module, and before it those it depends on, each once.
function(snug_add_module name)
  if(TARGET snug_${name})
    return()
  endif()
  if(NOT EXISTS ${PROJECT_SOURCE_DIR}/src/snug/${name}/CMakeLists.txt)
    message(FATAL_ERROR "No module '${name}': expected `all` or names of folders under ${PROJECT_SOURCE_DIR}/src/snug")
  endif()
  add_subdirectory(${PROJECT_SOURCE_DIR}/src/snug/${name} ${PROJECT_BINARY_DIR}/src/snug/${name})
endfunction()

# snug_compile_library(target [COLD] [ALONE]): ALONE where names of a library's files collide: each is compiled by itself.
function(snug_compile_library target)
  snug_compile_options(${target} LIBRARY ${ARGN})
  if("COLD" IN_LIST ARGN)
    snug_use_precompiled(${target} cold_library)
  else()
    snug_use_precompiled(${target} library)
  endif()
  if(SNUG_FAST_BUILD AND NOT "ALONE" IN_LIST ARGN)  # two fifths less work
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 12)
  endif()
endfunction()

function(snug_module name)
  cmake_parse_arguments(ARG "ALONE;COLD" "" "HEADERS;SOURCES;COLD_SOURCES;DEPENDS;LINK;TESTS;SLOW_TESTS;TEST_DEPENDS" ${ARGN})
  set(needs)
  foreach(module IN LISTS ARG_DEPENDS)
    snug_add_module(${module})
    get_property(more GLOBAL PROPERTY snug_needs_${module})
    list(APPEND needs ${more} ${module})
  endforeach()
  list(REMOVE_DUPLICATES needs)
  set_property(GLOBAL APPEND PROPERTY snug_modules ${name})
  set_property(GLOBAL PROPERTY snug_needs_${name} ${needs})
  set_property(GLOBAL PROPERTY snug_links_${name} ${ARG_LINK})
  foreach(library IN ITEMS Eigen3::Eigen LISTS ARG_LINK)
    snug_find_dependency(${library} find_package REQUIRED)
  endforeach()
  add_library(snug_${name} STATIC ${ARG_SOURCES})
  add_library(snug::${name} ALIAS snug_${name})
  target_sources(snug_${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/src FILES ${ARG_HEADERS})
  set_target_properties(snug_${name} PROPERTIES LINKER_LANGUAGE CXX)
  target_compile_features(snug_${name} PUBLIC cxx_std_20)
  list(TRANSFORM ARG_DEPENDS PREPEND snug::)
  target_link_libraries(snug_${name} PUBLIC ${ARG_DEPENDS} Eigen3::Eigen PRIVATE ${ARG_LINK})
  set(manner)
  foreach(word IN ITEMS ALONE COLD)
    if(ARG_${word})
      list(APPEND manner ${word})
    endif()
  endforeach()
  snug_compile_library(snug_${name} ${manner})
  if(ARG_COLD_SOURCES AND SNUG_FAST_BUILD)
    add_library(snug_${name}_cold OBJECT ${ARG_COLD_SOURCES})
    target_include_directories(snug_${name}_cold PRIVATE ${PROJECT_SOURCE_DIR}/src)
    target_link_libraries(snug_${name}_cold PRIVATE ${ARG_DEPENDS} Eigen3::Eigen ${ARG_LINK})
    snug_compile_library(snug_${name}_cold COLD)
    target_sources(snug_${name} PRIVATE $<TARGET_OBJECTS:snug_${name}_cold>)
  else()
    target_sources(snug_${name} PRIVATE ${ARG_COLD_SOURCES})
  endif()
  if(SNUG_TESTS)
    add_custom_target(${name}_tests)  # what `make test MODULE=<name>` builds
    foreach(module IN LISTS ARG_TEST_DEPENDS)
      snug_add_module(${module})
    endforeach()
    list(TRANSFORM ARG_TEST_DEPENDS PREPEND snug::)
  endif()
  if(SNUG_TESTS AND ARG_TESTS)
    snug_test(${name}_test SOURCES ${ARG_TESTS} LINK snug::${name} ${ARG_TEST_DEPENDS} ${ARG_LINK} LABELS "${name}")
    add_dependencies(${name}_tests ${name}_test)
  endif()
  if(SNUG_TESTS AND ARG_SLOW_TESTS)
    snug_test(${name}_slow_test SOURCES ${ARG_SLOW_TESTS} LINK snug::${name} ${ARG_TEST_DEPENDS} ${ARG_LINK} LABELS "${name};slow")
    add_dependencies(${name}_tests ${name}_slow_test)
  endif()
endfunction()

# snug_app_library(name [COLD] SOURCES ... DEPENDS modules... LINK libraries... TESTS files...): a library of the programs, from the folder
# it is called in: snug::<name> as modules are, but not installed, and its includes start at the project's folder: "bench/figures/file.hpp".
function(snug_app_library name)
  cmake_parse_arguments(ARG "COLD" "" "SOURCES;DEPENDS;LINK;TESTS" ${ARGN})
  add_library(snug_${name} STATIC ${ARG_SOURCES})
  add_library(snug::${name} ALIAS snug_${name})
  target_include_directories(snug_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_compile_features(snug_${name} PUBLIC cxx_std_20)
  list(TRANSFORM ARG_DEPENDS PREPEND snug::)
  foreach(library IN LISTS ARG_LINK)
    snug_find_dependency(${library} find_package REQUIRED)
  endforeach()
  target_link_libraries(snug_${name} PUBLIC ${ARG_DEPENDS} PRIVATE ${ARG_LINK})
  set(manner)
  if(ARG_COLD)
    set(manner COLD)
  endif()
  snug_compile_library(snug_${name} ${manner})
  if(SNUG_TESTS)
    add_custom_target(${name}_tests)
    snug_test(${name}_test SOURCES ${ARG_TESTS} LINK snug::${name} ${ARG_LINK} LABELS "${name}")
    add_dependencies(${name}_tests ${name}_test)
  endif()
endfunction()
