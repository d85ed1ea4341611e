# Compiler and linker settings, and functions to add a library or a test.

find_program(MOCURATE_CCACHE ccache)
if(MOCURATE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_C_COMPILER_LAUNCHER ${MOCURATE_CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${PROJECT_SOURCE_DIR}/cmake/ccache.sh ${MOCURATE_CCACHE} ${PROJECT_SOURCE_DIR})
endif()
find_program(MOCURATE_MOLD mold)
if(MOCURATE_MOLD)
  add_link_options(-fuse-ld=mold)
endif()

add_library(mocurate_settings INTERFACE)
target_include_directories(mocurate_settings INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
# g++ 12 wrongly reports Eigen's fixed-size storage as uninitialised after inlining.
target_compile_options(mocurate_settings INTERFACE -Wall -Wextra -Wshadow -Wno-psabi
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
# g++ collects garbage from 128 MB of its heap on, which takes a tenth of the compile time; from 600 MB on most sources
# are done before. The objects are the same; the largest source, of 1.6 GB, takes 7 % more memory.
target_compile_options(mocurate_settings INTERFACE $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=600000>)
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

# mocurate_unity(TARGET [GROUP N]): sources of one folder are compiled N at a time (default 8), as parsing headers is most
# of what a small source takes. Debug builds, the sanitizers and scripts/tidy.sh compile each source alone, where a
# missing include is noticed. Two sources of a group that name something alike in their unnamed namespaces do not
# compile: what they share belongs in a header. Eigen-heavy sources are all code: fitting takes smaller groups.
function(mocurate_unity target)
  cmake_parse_arguments(arg "" "GROUP" "" ${ARGN})
  if(NOT MOCURATE_UNITY)
    return()
  endif()
  if(NOT arg_GROUP)
    set(arg_GROUP 8)
  endif()
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources EXCLUDE REGEX "^\\$<")  # objects of another target
  get_target_property(target_folder ${target} SOURCE_DIR)
  foreach(source ${sources})
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${target_folder})
    cmake_path(GET source PARENT_PATH folder)
    cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE name)
    string(SHA1 hash "${name}")  # a-b and a_b are two folders and one identifier
    string(SUBSTRING "${hash}" 0 6 hash)
    string(MAKE_C_IDENTIFIER "${name}_${hash}" name)
    if(NOT DEFINED count_${name})
      set(count_${name} 0)
    endif()
    math(EXPR group "${count_${name}} / ${arg_GROUP}")
    math(EXPR count_${name} "${count_${name}} + 1")
    set_source_files_properties(${source} TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP "${name}_${group}")
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # A type of an unnamed namespace is of one source still, if not of the one that g++ was given.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()

# Common headers, parsed once for all sources: a quarter of the libraries' compile time. Only for g++, which accepts one
# precompiled header for targets with different options.
function(mocurate_headers)
  add_library(mocurate_headers OBJECT ${PROJECT_SOURCE_DIR}/core/precompiled.cpp)
  target_link_libraries(mocurate_headers PRIVATE mocurate_settings Eigen3::Eigen nlohmann_json::nlohmann_json)
  target_include_directories(mocurate_headers SYSTEM PRIVATE ${MOCURATE_EXPECTED_INCLUDE})
  target_precompile_headers(mocurate_headers PRIVATE ${PROJECT_SOURCE_DIR}/core/precompiled.h)
endfunction()

# mocurate_library(NAME SOURCES ... PUBLIC ... PRIVATE ... [OWN_HEADERS] [GROUP N]): static library mocurate_NAME. Sources may be
# globs relative to the calling folder. PUBLIC and PRIVATE are libraries to link. OWN_HEADERS: nothing is precompiled for
# it (libraries that ask for another ABI macro). GROUP: of mocurate_unity.
function(mocurate_library name)
  cmake_parse_arguments(arg "OWN_HEADERS" "GROUP" "SOURCES;EXCLUDE;PUBLIC;PRIVATE" ${ARGN})
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
  mocurate_unity(mocurate_${name} GROUP ${arg_GROUP})
  if(TARGET mocurate_headers AND NOT arg_OWN_HEADERS)
    target_precompile_headers(mocurate_${name} REUSE_FROM mocurate_headers)
  endif()
endfunction()

# The two paths that tests need, alone in a library: what holds a path is compiled again in each clone.
function(mocurate_test_folders)
  if(TARGET mocurate_test_folders)
    return()
  endif()
  add_library(mocurate_test_folders STATIC ${PROJECT_SOURCE_DIR}/tests/support/folders.cpp)
  target_link_libraries(mocurate_test_folders PUBLIC mocurate_settings)
  target_compile_definitions(mocurate_test_folders PRIVATE MOCURATE_SOURCE_FOLDER="${PROJECT_SOURCE_DIR}"
                                                           MOCURATE_BINARY_FOLDER="${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
endfunction()

# Common headers of tests, parsed once: a quarter of the tests' compile time. Tests are compiled with -O1, which saves a
# fifth; the tested libraries have the options of the installed ones. Paths in __FILE__, which GoogleTest's macros hold,
# are relative: ccache serves another clone.
set(MOCURATE_TEST_OPTIONS $<$<CONFIG:Release>:-O1> -fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=)
function(mocurate_test_headers)
  add_library(mocurate_test_headers OBJECT ${PROJECT_SOURCE_DIR}/tests/precompiled.cpp)
  target_link_libraries(mocurate_test_headers PRIVATE mocurate_settings Eigen3::Eigen nlohmann_json::nlohmann_json GTest::gmock
                                                      GTest::gtest)
  target_compile_options(mocurate_test_headers PRIVATE -fPIE ${MOCURATE_TEST_OPTIONS})
  target_precompile_headers(mocurate_test_headers PRIVATE ${PROJECT_SOURCE_DIR}/tests/precompiled.h)
endfunction()

# Suites of the cases in test sources; CMake runs again when one of these changes. With DATA: only those of sources that
# read recorded data or goldens.
set(MOCURATE_READS_DATA "MOCURATE_(DATA|GOLDENS|RECORDED)|TestData\\(|DataFolder\\(|Recorded(Data|File|Folder|Path)"
                        "|ReferenceFolder\\(|changed_files.h|DepthTakes|CloudTakes|Golden[A-Z][a-z]+\\(")
string(CONCAT MOCURATE_READS_DATA ${MOCURATE_READS_DATA})
function(mocurate_suites result)
  cmake_parse_arguments(arg "DATA" "" "" ${ARGN})
  set(suites "")
  foreach(source ${arg_UNPARSED_ARGUMENTS})
    file(STRINGS ${source} reads LIMIT_COUNT 1 REGEX "${MOCURATE_READS_DATA}")
    if(arg_DATA AND NOT reads)
      continue()
    endif()
    file(STRINGS ${source} cases REGEX "^TEST(_F|_P)?\\(")
    foreach(case ${cases})
      string(REGEX REPLACE "^TEST[_FP]*\\(([A-Za-z0-9]+),.*" "\\1" suite "${case}")
      list(APPEND suites ${suite})
    endforeach()
  endforeach()
  list(REMOVE_DUPLICATES suites)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${arg_UNPARSED_ARGUMENTS})
  set(${result} ${suites} PARENT_SCOPE)
endfunction()

# mocurate_test(NAME LIBRARIES ... [WHOLE] [SLOW suites]): one executable test_NAME from tests/NAME/*.cpp and the folders
# of subjects in it. A CTest test is one process, as starting programs 2,000 times took a tenth of the time of all tests:
# it runs all suites of one label (base.unit, base.data), which share what they make. Suites of SLOW are tests of their
# own, the longest first; with WHOLE the executable is one test. Labels: slow (SLOW, WHOLE), data (reads recorded data or
# goldens), else unit. TIMEOUT: of each test, seconds (900).
function(mocurate_test name)
  cmake_parse_arguments(arg "WHOLE" "TIMEOUT" "LIBRARIES;SLOW" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tests/${name}/*.cpp
                                      ${PROJECT_SOURCE_DIR}/tests/${name}/*/*_test.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(test_${name} ${sources})
  target_link_libraries(test_${name} PRIVATE ${arg_LIBRARIES} mocurate_test_folders GTest::gmock GTest::gtest GTest::gtest_main)
  target_compile_options(test_${name} PRIVATE ${MOCURATE_TEST_OPTIONS})
  mocurate_unity(test_${name})
  if(NOT arg_WHOLE AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_precompile_headers(test_${name} REUSE_FROM mocurate_test_headers)
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 900)
  endif()
  if(arg_WHOLE)
    mocurate_add_test(test_${name} ${name} slow 100 ${arg_TIMEOUT} "*")
    return()
  endif()
  # CTest starts costly tests first, so that the last one to end is a short one. Those of a label cost as many sources.
  set(cost 200)
  list(LENGTH sources count)
  set(slow "")
  set(data "")
  mocurate_suites(suites ${sources})
  foreach(suite ${arg_SLOW})
    if(NOT suite IN_LIST suites)
      message(FATAL_ERROR "test_${name} has no suite ${suite}")
    endif()
    mocurate_add_test(test_${name} ${name}.${suite} slow ${cost} ${arg_TIMEOUT} "${suite}.*:*/${suite}.*")
    math(EXPR cost "${cost} - 5")
    string(APPEND slow "${suite}.*:*/${suite}.*:")
  endforeach()
  mocurate_suites(data_suites DATA ${sources})
  list(REMOVE_ITEM data_suites "" ${arg_SLOW})
  if(data_suites)
    foreach(suite ${data_suites})
      string(APPEND data "${suite}.*:*/${suite}.*:")
    endforeach()
    mocurate_add_test(test_${name} ${name}.data data ${count} ${arg_TIMEOUT} "${data}")
  endif()
  # Also the cases that mocurate_suites does not find, such as those of a macro.
  mocurate_add_test(test_${name} ${name}.unit unit ${count} ${arg_TIMEOUT} "*-${slow}${data}")
endfunction()

# The CTest test TEST: the cases of a filter, in one process of TARGET. It fails when one fails, and is reported as
# skipped when one is skipped and none fails.
function(mocurate_add_test target test label cost timeout filter)
  add_test(NAME ${test} COMMAND ${PROJECT_SOURCE_DIR}/cmake/run_whole.sh $<TARGET_FILE:${target}>
    --gtest_filter=${filter})
  if(MOCURATE_SANITIZE)
    math(EXPR timeout "8 * ${timeout}")
  endif()
  set_tests_properties(${test} PROPERTIES TIMEOUT ${timeout} SKIP_RETURN_CODE 77 LABELS ${label} COST ${cost})
endfunction()
