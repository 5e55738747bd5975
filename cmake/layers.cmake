# rdm_flags: what all our code is compiled with. Fused multiply-add stays off so that results do not
# depend on how the compiler contracts; x86-64-v2 is the oldest machine that is supported.
add_library(rdm_flags INTERFACE)
target_compile_features(rdm_flags INTERFACE cxx_std_20 c_std_99)
target_compile_options(rdm_flags INTERFACE -ffp-contract=off -fno-math-errno
                       -Wall -Wextra -Wpedantic -Wconversion $<$<CXX_COMPILER_ID:Clang>:-Wno-sign-conversion>
                       $<$<BOOL:${REDMAN_WERROR}>:-Werror>)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
  target_compile_options(rdm_flags INTERFACE -march=x86-64-v2)
endif()
if(WIN32)
  # the C library's printf is GCC's own there, whose formats the builds for other systems check
  target_compile_definitions(rdm_flags INTERFACE __USE_MINGW_ANSI_STDIO=1)
  target_compile_options(rdm_flags INTERFACE -Wno-format)
  target_link_options(rdm_flags INTERFACE -static)
endif()
if(REDMAN_SANITIZE)
  target_compile_options(rdm_flags INTERFACE -fsanitize=${REDMAN_SANITIZE} -fno-omit-frame-pointer
                         -fno-sanitize-recover=all)
  target_link_options(rdm_flags INTERFACE -fsanitize=${REDMAN_SANITIZE})
endif()
if(REDMAN_COVERAGE)
  target_compile_options(rdm_flags INTERFACE --coverage -fprofile-update=atomic)
  target_link_options(rdm_flags INTERFACE --coverage)
endif()

if(REDMAN_POLICY AND NOT REDMAN_SIM AND NOT REDMAN_LEARN AND NOT REDMAN_STUBS)
  target_compile_definitions(rdm_flags INTERFACE RDM_POLICIES_ALONE)
endif()

# Most of what a small file takes to compile are the headers that all of its layer read. A build that is made once lets
# many files share them; one that is edited three, so that an edit stays quick. The numerical kernels stay alone: what a
# compiler inlines depends on what else it sees.
set(RDM_UNITY OFF)
set(RDM_FILES_TOGETHER 3)
if(CMAKE_CROSSCOMPILING OR WIN32)
  set(RDM_FILES_TOGETHER 1)
endif()
set(RDM_ALONE map.cpp own_task.cpp planner.cpp pool.cpp recording.cpp robots.cpp scene.cpp world.cpp)  # of capi
if(CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT CMAKE_CROSSCOMPILING AND NOT WIN32)
  set(RDM_UNITY ON)
  set(RDM_FILES_TOGETHER 14)
endif()

set(RDM_OFF_ROWS "")  # of what is switched off
if(NOT REDMAN_SIM)
  list(APPEND RDM_OFF_ROWS physics robot objects sense env plan shield tasks)
endif()
if(NOT REDMAN_LEARN)
  list(APPEND RDM_OFF_ROWS algos)
endif()
if(NOT REDMAN_SIM AND NOT REDMAN_LEARN)
  list(APPEND RDM_OFF_ROWS record)
endif()
if(NOT REDMAN_POLICY)
  list(APPEND RDM_OFF_ROWS nn)
  if(REDMAN_LEARN)
    message(FATAL_ERROR "REDMAN_LEARN=ON needs REDMAN_POLICY=ON")
  endif()
endif()
set(RDM_ROWS "")

# The public headers, in the order in which redman.h includes them: the stable ones first.
execute_process(COMMAND sh ${PROJECT_SOURCE_DIR}/cmake/headers.sh ${PROJECT_SOURCE_DIR}/include
                OUTPUT_VARIABLE RDM_HEADERS OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE "\n" ";" RDM_HEADERS "${RDM_HEADERS}")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/include/redman/redman.h)

# Which halves there are, for capi/stubs.awk.
find_program(RDM_AWK NAMES mawk gawk awk REQUIRED)
set(RDM_HALVES "")
foreach(half SIM LEARN POLICY STUBS)
  string(TOLOWER ${half} name)
  if(REDMAN_${half})
    list(APPEND RDM_HALVES -v ${name}=1)
  else()
    list(APPEND RDM_HALVES -v ${name}=0)
  endif()
endforeach()
list(APPEND RDM_HALVES -f ${PROJECT_SOURCE_DIR}/capi/stubs.awk)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/capi/stubs.awk)

# With REDMAN_STUBS=OFF the names that this build leaves out: no list of exports has them.
set(RDM_LEFT_OUT "")
if(NOT REDMAN_STUBS)
  execute_process(COMMAND ${RDM_AWK} -v names=1 ${RDM_HALVES} ${RDM_HEADERS} ${PROJECT_SOURCE_DIR}/capi/redman_old.symbols
                  OUTPUT_VARIABLE RDM_LEFT_OUT COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "rdm_[a-z_0-9]+" RDM_LEFT_OUT "${RDM_LEFT_OUT}")
endif()

# rdm_written(list file old headers...): appends the file that capi/stubs.awk writes from the headers. old 0: the functions of
# the halves that are left out; 1: those that have another name now.
function(rdm_written list file old)
  list(JOIN RDM_HALVES "' '" halves)
  list(JOIN ARGN "' '" headers)
  add_custom_command(OUTPUT ${file} DEPENDS ${ARGN} ${PROJECT_SOURCE_DIR}/capi/stubs.awk VERBATIM
    COMMAND sh -c "'${RDM_AWK}' -v old=${old} '${halves}' '${headers}' > '${file}'")
  set(${list} ${${list}} ${file} PARENT_SCOPE)
endfunction()

# rdm_layer(name folder SEES rows... LINKS libraries...): the folder's sources as the object library
# rdm_<name>. A folder without sources is no target; a row of a half that is switched off is left out.
function(rdm_layer name folder)
  cmake_parse_arguments(arg "" "" "SEES;LINKS" ${ARGN})
  list(JOIN arg_SEES " " sees)
  set(RDM_TABLE "${RDM_TABLE}${name} ${folder} ${sees}\n" PARENT_SCOPE)
  if(name IN_LIST RDM_OFF_ROWS)
    return()
  endif()
  set(RDM_ROWS ${RDM_ROWS} ${name} PARENT_SCOPE)
  set(RDM_SEES_${name} ${arg_SEES} PARENT_SCOPE)
  set(RDM_LINKS_${name} ${arg_LINKS} PARENT_SCOPE)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "/capi/import/")  # a library of its own (import.cmake)
  if(NOT sources)
    return()
  endif()
  if(name STREQUAL "capi")
    rdm_written(sources ${PROJECT_BINARY_DIR}/old_names.cpp 1 ${PROJECT_SOURCE_DIR}/include/redman/deprecated.h)
    if(REDMAN_STUBS AND NOT (REDMAN_SIM AND REDMAN_LEARN))
      rdm_written(sources ${PROJECT_BINARY_DIR}/stubs.cpp 0 ${RDM_HEADERS})
    endif()
  endif()
  add_library(rdm_${name} OBJECT ${sources})
  target_include_directories(rdm_${name} PRIVATE ${PROJECT_SOURCE_DIR}/lib)
  target_link_libraries(rdm_${name} PRIVATE rdm_flags ${arg_LINKS})
  set_target_properties(rdm_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON
                        CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  if(RDM_FILES_TOGETHER GREATER 1 AND name MATCHES "^(base|record|env|plan|algos)$")
    set_target_properties(rdm_${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${RDM_FILES_TOGETHER})
    # alone, so that test `recipes` can put another in its place
    set_source_files_properties(${PROJECT_SOURCE_DIR}/algos/algo_registry.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  elseif(RDM_UNITY AND name STREQUAL "capi" AND REDMAN_SIM AND REDMAN_LEARN)
    set_target_properties(rdm_capi PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 14)
    # have small helpers of the same names, which differ
    list(TRANSFORM RDM_ALONE PREPEND ${PROJECT_SOURCE_DIR}/capi/ OUTPUT_VARIABLE alone)
    set_source_files_properties(${alone} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
  # The loops that a step and an update live in are in the other layers. These are read in, set up and told about, where
  # -O3 gives bytes and no speed.
  if(name MATCHES "^(record|objects|robot|tasks|algos|capi)$")
    target_compile_options(rdm_${name} PRIVATE $<$<CONFIG:Release>:-O2>)
  endif()
  if(name MATCHES "^(tasks|algos|capi)$")
    target_include_directories(rdm_${name} PRIVATE ${PROJECT_SOURCE_DIR})
  endif()
  if(name STREQUAL "capi")
    target_include_directories(rdm_capi PRIVATE ${PROJECT_SOURCE_DIR}/include)
    target_compile_definitions(rdm_capi PRIVATE RDM_EXPERIMENTAL RDM_NO_DEPRECATED
      RDM_WITH_SIM=$<BOOL:${REDMAN_SIM}> RDM_WITH_LEARN=$<BOOL:${REDMAN_LEARN}>
      RDM_WITH_POLICY=$<BOOL:${REDMAN_POLICY}> RDM_STUBS=$<BOOL:${REDMAN_STUBS}>
      RDM_ODE_VERSION="${RDM_VERSION_TEXT_ODE}" RDM_CCD_VERSION="${RDM_VERSION_TEXT_CCD}"
      RDM_EIGEN_VERSION="${RDM_VERSION_TEXT_EIGEN}" RDM_OCTOMAP_VERSION="${RDM_VERSION_TEXT_OCTOMAP}")
  endif()
endfunction()

# rdm_use_rows(target rows...): the objects of the rows, and what they link.
function(rdm_use_rows target)
  foreach(row ${ARGN})
    if(TARGET rdm_${row})
      target_sources(${target} PRIVATE $<TARGET_OBJECTS:rdm_${row}>)
    endif()
    list(APPEND links ${RDM_LINKS_${row}})
  endforeach()
  list(REMOVE_DUPLICATES links)
  list(REMOVE_ITEM links Eigen3::Eigen)  # headers only
  target_link_libraries(${target} PRIVATE ${links})
endfunction()

# rdm_export(target lists...): the shared library exports the names of the checked-in lists (file:NODE, file:NODE:PARENT;
# several files of a node as file+file) and nothing else. With the linkers of ELF each list has a node of its own: what 1.0 adds is in REDMAN_1.0, so that the
# loader refuses a program that is too new for a library, and experimental names are in a node of their minor release.
# On macOS the lists are untested.
function(rdm_export target)
  set(all "")
  set(nodes "")
  set(local " local: *;")
  foreach(list ${ARGN})
    string(REPLACE ":" ";" list "${list}")
    list(POP_FRONT list name node parent)
    string(REPLACE "+" ";" files ${name})
    set(names "")
    foreach(file ${files})
      set(file ${PROJECT_SOURCE_DIR}/capi/${file}.symbols)
      set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
      file(STRINGS ${file} some REGEX "^rdm_")
      list(APPEND names ${some})
    endforeach()
    list(REMOVE_ITEM names ${RDM_LEFT_OUT} "")
    if(NOT names)
      continue()
    endif()
    list(APPEND all ${names})
    list(JOIN names "; " names)
    string(APPEND nodes "${node} { global: ${names};${local} } ${parent};\n")
    set(local "")
  endforeach()
  if(WIN32)
    set(map ${PROJECT_BINARY_DIR}/${target}.def)
    list(JOIN all "\n  " names)
    file(CONFIGURE OUTPUT ${map} CONTENT "EXPORTS\n  ${names}\n")
    target_sources(${target} PRIVATE ${map})
    target_link_options(${target} PRIVATE -static)  # one file that needs Windows and nothing else
  elseif(APPLE)
    set(map ${PROJECT_BINARY_DIR}/${target}.exports)
    list(JOIN all "\n_" names)
    file(CONFIGURE OUTPUT ${map} CONTENT "_${names}\n")
    target_link_options(${target} PRIVATE -Wl,-exported_symbols_list,${map})
  else()
    set(map ${PROJECT_BINARY_DIR}/${target}.map)
    file(CONFIGURE OUTPUT ${map} CONTENT "${nodes}")
    target_link_options(${target} PRIVATE -Wl,--as-needed -Wl,--version-script=${map})
    if(NOT REDMAN_SANITIZE)
      target_link_options(${target} PRIVATE -Wl,-z,defs)
    endif()
  endif()
  set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS ${map})
endfunction()

# rdm_archive(target): a plugin that links this static library exports none of its names; a project in C links it.
function(rdm_archive target)
  get_target_property(name ${target} OUTPUT_NAME)
  target_compile_definitions(${target} INTERFACE RDM_STATIC)
  target_link_options(${target} INTERFACE $<$<PLATFORM_ID:Linux>:LINKER:--exclude-libs,lib${name}.a>)
  # a project without C++ links what the compiler of C++ would add
  if(NOT RDM_STANDALONE_ARCHIVE)
    target_link_libraries(${target} INTERFACE $<$<LINK_LANGUAGE:C>:$<IF:$<PLATFORM_ID:Darwin>,c++,stdc++>>)
  endif()
  target_link_libraries(${target} INTERFACE $<$<LINK_LANGUAGE:C>:m>)
endfunction()

# rdm_library(target STATIC|SHARED) from the objects of all layers.
function(rdm_library target kind)
  add_library(${target} ${kind})
  add_library(redman::${target} ALIAS ${target})
  rdm_use_rows(${target} ${RDM_ROWS})
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                             $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  set_target_properties(${target} PROPERTIES OUTPUT_NAME redman LINKER_LANGUAGE CXX
                        VERSION ${PROJECT_VERSION} SOVERSION ${RDM_ABI})
  if(REDMAN_COVERAGE)
    target_link_options(${target} PUBLIC --coverage)
  endif()
  if(REDMAN_SANITIZE)
    target_link_options(${target} PUBLIC -fsanitize=${REDMAN_SANITIZE})
  endif()
  if(kind STREQUAL "SHARED")
    rdm_export(${target} redman+redman_old:REDMAN_${RDM_ABI} redman_1.0:REDMAN_1.0:REDMAN_${RDM_ABI}
               redman_experimental:REDMAN_EXPERIMENTAL_${RDM_VERSION_MAJOR}_${RDM_VERSION_MINOR})
  else()
    rdm_archive(${target})
  endif()
endfunction()

# rdm_standalone(target): the static library carries the C++ runtime (cmake/packaging/standalone.sh).
function(rdm_standalone target)
  set(names "")
  file(GLOB lists CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/capi/*.symbols)
  foreach(list ${lists})
    file(STRINGS ${list} some REGEX "^rdm_")
    list(APPEND names ${some})
  endforeach()
  list(REMOVE_ITEM names ${RDM_LEFT_OUT} "")
  list(JOIN names "\n" names)
  set(list ${PROJECT_BINARY_DIR}/${target}.names)
  file(CONFIGURE OUTPUT ${list} CONTENT "${names}\n")
  set(script ${PROJECT_SOURCE_DIR}/cmake/packaging/standalone.sh)
  add_library(rdm_terminate OBJECT cmake/packaging/terminate.cpp)
  target_link_libraries(rdm_terminate PRIVATE rdm_flags)
  add_dependencies(${target} rdm_terminate)
  set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS ${list} ${script})
  add_custom_command(TARGET ${target} POST_BUILD VERBATIM COMMAND sh ${script} ${CMAKE_CXX_COMPILER} ${CMAKE_OBJCOPY} ${CMAKE_NM}
                     ${CMAKE_AR} $<TARGET_FILE:${target}> ${list} $<TARGET_OBJECTS:rdm_terminate> COMMAND_EXPAND_LISTS)
endfunction()
