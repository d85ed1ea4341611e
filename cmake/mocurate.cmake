# Compiler and linker settings, and the one way to add a library or a test.

find_program(MOCURATE_CCACHE ccache)
if(MOCURATE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_C_COMPILER_LAUNCHER ${MOCURATE_CCACHE})
  # What ccache asks for where headers are precompiled.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros
    ${MOCURATE_CCACHE})
endif()
find_program(MOCURATE_MOLD mold)
if(MOCURATE_MOLD)
  add_link_options(-fuse-ld=mold)
endif()

add_library(mocurate_settings INTERFACE)
target_include_directories(mocurate_settings INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
# g++ 12 takes Eigen's fixed-size storage for uninitialised after inlining.
target_compile_options(mocurate_settings INTERFACE -Wall -Wextra -Wshadow -Wno-psabi
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
if(MOCURATE_WARNINGS_AS_ERRORS)
  target_compile_options(mocurate_settings INTERFACE -Werror)
endif()
if(MOCURATE_SANITIZE)
  add_compile_options(-fsanitize=${MOCURATE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${MOCURATE_SANITIZE})
endif()

if(MOCURATE_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

# mocurate_unity(TARGET [BATCH N]): up to N sources of a target, else 16, are compiled as one, as parsing headers is most of
# what a small source takes. All sources of a room must then have names of their own in their unnamed namespaces
# (tests/layers); debug builds, the sanitizers and scripts/tidy.sh compile each source apart, where an include that is
# missing is noticed. Larger batches gain little: three quarters of the time of 16 is spent on their code. Eigen-heavy sources
# are all code: 16 of fitting took 95 s and 2 GB, so fewer are taken there, for two processors to share them.
function(mocurate_unity target)
  cmake_parse_arguments(arg "" "BATCH" "" ${ARGN})
  if(NOT arg_BATCH)
    set(arg_BATCH 16)
  endif()
  if(MOCURATE_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${arg_BATCH})
    # A type of an unnamed namespace is of one source still, if not of the one that g++ was given.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
endfunction()

# What nearly every source includes, parsed once for all of them: a quarter of the time that compiling the libraries takes.
# Only for g++, which takes one header for targets whose other options differ.
function(mocurate_headers)
  add_library(mocurate_headers OBJECT ${PROJECT_SOURCE_DIR}/core/precompiled.cpp)
  target_link_libraries(mocurate_headers PRIVATE mocurate_settings Eigen3::Eigen nlohmann_json::nlohmann_json)
  target_include_directories(mocurate_headers SYSTEM PRIVATE ${MOCURATE_EXPECTED_INCLUDE})
  target_precompile_headers(mocurate_headers PRIVATE ${PROJECT_SOURCE_DIR}/core/precompiled.h)
endfunction()

# mocurate_library(NAME SOURCES ... PUBLIC ... PRIVATE ... [OWN_HEADERS] [BATCH N]): static library mocurate_NAME. Sources may be
# globs relative to the calling folder. PUBLIC and PRIVATE are libraries to link. OWN_HEADERS: nothing is precompiled for
# it (libraries that ask for another ABI macro). BATCH: of mocurate_unity.
function(mocurate_library name)
  cmake_parse_arguments(arg "OWN_HEADERS" "BATCH" "SOURCES;EXCLUDE;PUBLIC;PRIVATE" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${arg_SOURCES})
  foreach(pattern ${arg_EXCLUDE})
    list(FILTER sources EXCLUDE REGEX "${pattern}")
  endforeach()
  if(NOT sources)
    add_library(mocurate_${name} INTERFACE)
    target_link_libraries(mocurate_${name} INTERFACE mocurate_settings ${arg_PUBLIC} ${arg_PRIVATE})
    return()
  endif()
  add_library(mocurate_${name} STATIC ${sources})
  target_link_libraries(mocurate_${name} PUBLIC mocurate_settings ${arg_PUBLIC} PRIVATE ${arg_PRIVATE})
  mocurate_unity(mocurate_${name} BATCH ${arg_BATCH})
  if(TARGET mocurate_headers AND NOT arg_OWN_HEADERS)
    target_precompile_headers(mocurate_${name} REUSE_FROM mocurate_headers)
  endif()
endfunction()

# What nearly every test includes, parsed once for all of them: a quarter of the time that compiling the tests takes.
# Tests are compiled with -O1, which takes a fifth less; what they test is compiled as it is installed.
set(MOCURATE_TEST_OPTIONS $<$<CONFIG:Release>:-O1>)
function(mocurate_test_headers)
  add_library(mocurate_test_headers OBJECT ${PROJECT_SOURCE_DIR}/tests/precompiled.cpp)
  target_link_libraries(mocurate_test_headers PRIVATE mocurate_settings Eigen3::Eigen nlohmann_json::nlohmann_json GTest::gmock
                                                      GTest::gtest)
  target_compile_options(mocurate_test_headers PRIVATE -fPIE ${MOCURATE_TEST_OPTIONS})
  target_precompile_headers(mocurate_test_headers PRIVATE ${PROJECT_SOURCE_DIR}/tests/precompiled.h)
endfunction()

# Suites of the cases in test sources; CMake runs again when one of these changes.
function(mocurate_suites result)
  set(suites "")
  foreach(source ${ARGN})
    file(STRINGS ${source} cases REGEX "^TEST(_F|_P)?\\(")
    foreach(case ${cases})
      string(REGEX REPLACE "^TEST[_FP]*\\(([A-Za-z0-9]+),.*" "\\1" suite "${case}")
      list(APPEND suites ${suite})
    endforeach()
  endforeach()
  list(REMOVE_DUPLICATES suites)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${ARGN})
  set(${result} ${suites} PARENT_SCOPE)
endfunction()

# mocurate_test(NAME LIBRARIES ... [WHOLE | SUITES | TOGETHER suites]): one executable test_NAME from tests/NAME/*.cpp.
# Each case is a CTest test. With WHOLE the executable is one CTest test, with SUITES each suite is (programs whose
# start-up is slow); so are suites of TOGETHER, whose cases share what takes long to make.
function(mocurate_test name)
  cmake_parse_arguments(arg "WHOLE;SUITES" "TIMEOUT" "LIBRARIES;TOGETHER" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tests/${name}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(test_${name} ${sources})
  target_link_libraries(test_${name} PRIVATE ${arg_LIBRARIES} GTest::gmock GTest::gtest GTest::gtest_main)
  target_compile_definitions(test_${name} PRIVATE MOCURATE_TEST_SOURCE_FOLDER="${PROJECT_SOURCE_DIR}/tests/${name}"
                                                  MOCURATE_SOURCE_FOLDER="${PROJECT_SOURCE_DIR}"
                                                  MOCURATE_BINARY_FOLDER="${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
  target_compile_options(test_${name} PRIVATE ${MOCURATE_TEST_OPTIONS})
  mocurate_unity(test_${name})
  if(NOT arg_WHOLE AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_precompile_headers(test_${name} REUSE_FROM mocurate_test_headers)
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()
  # One process for several cases: a failure fails it, a skip is reported only when nothing failed.
  set(whole ${PROJECT_SOURCE_DIR}/cmake/run_whole.sh $<TARGET_FILE:test_${name}> --gtest_brief=1)
  if(arg_WHOLE)
    add_test(NAME ${name} COMMAND ${whole})
    set_tests_properties(${name} PROPERTIES TIMEOUT ${arg_TIMEOUT} SKIP_RETURN_CODE 77)
    return()
  endif()
  if(arg_SUITES)
    mocurate_suites(arg_TOGETHER ${sources})
  endif()
  math(EXPR together_timeout "3 * ${arg_TIMEOUT}")
  set(others "*-")
  foreach(suite ${arg_TOGETHER})
    add_test(NAME ${name}.${suite} COMMAND ${whole} --gtest_filter=${suite}.*:*/${suite}.*)
    set_tests_properties(${name}.${suite} PROPERTIES TIMEOUT ${together_timeout} SKIP_RETURN_CODE 77)
    string(APPEND others "${suite}.*:")
  endforeach()
  if(NOT arg_SUITES)
    include(GoogleTest)
    gtest_discover_tests(test_${name} TEST_PREFIX "${name}." TEST_FILTER "${others}" PROPERTIES TIMEOUT ${arg_TIMEOUT}
      DISCOVERY_TIMEOUT 60)
  endif()
endfunction()
