# Numbered example programs, one file each, and the command-line tool in examples/redman: all see the
# public headers alone.
set(RDM_EXAMPLES "")
function(rdm_example target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic $<$<BOOL:${REDMAN_WERROR}>:-Werror>)
  target_link_libraries(${target} PRIVATE $<IF:$<BOOL:${REDMAN_SHARED}>,redman,redman_static>)
  if(WIN32)  # as in rdm_flags
    target_compile_definitions(${target} PRIVATE __USE_MINGW_ANSI_STDIO=1)
    target_compile_options(${target} PRIVATE -Wno-format -Wno-format-extra-args)
  endif()
  if(REDMAN_SANITIZE)
    # GCC takes members of <regex> for uninitialised once they are instrumented
    target_compile_options(${target} PRIVATE -fsanitize=${REDMAN_SANITIZE} -fno-omit-frame-pointer
                           $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  endif()
endfunction()

file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/examples/[0-9]*.c ${PROJECT_SOURCE_DIR}/examples/[0-9]*.cpp)
foreach(source ${sources})
  get_filename_component(name ${source} NAME_WE)
  file(STRINGS ${source} imports REGEX "redman/import.h")
  if(imports AND NOT TARGET redman_import_static)
    continue()
  endif()
  add_executable(${name} ${source})
  set_target_properties(${name} PROPERTIES C_STANDARD 99 CXX_STANDARD 20)
  if(imports)
    target_link_libraries(${name} PRIVATE $<IF:$<BOOL:${REDMAN_SHARED}>,redman_import,redman_import_static>)
  endif()
  target_link_libraries(${name} PRIVATE m)
  rdm_example(${name})
  list(APPEND RDM_EXAMPLES ${name})
endforeach()

# One learner of many processes: by fork, and by MPI where it is asked for.
option(REDMAN_MPI "MPI for the tool (train --ranks mpi) and examples/distributed; needs an MPI for C" OFF)
set(RDM_DISTRIBUTED ${PROJECT_SOURCE_DIR}/examples/distributed)
add_executable(distributed_simulate ${RDM_DISTRIBUTED}/simulate.c)
set(distributed distributed_simulate)
if(CMAKE_SYSTEM_NAME STREQUAL "Linux")  # it waits by futex
  add_executable(distributed_fork ${RDM_DISTRIBUTED}/train.c ${RDM_DISTRIBUTED}/fork_ranks.c)
  list(APPEND distributed distributed_fork)
endif()
if(REDMAN_MPI)
  find_package(MPI REQUIRED COMPONENTS C)
  add_executable(distributed_mpi ${RDM_DISTRIBUTED}/train.c ${RDM_DISTRIBUTED}/mpi_ranks.c)
  target_compile_definitions(distributed_mpi PRIVATE USE_MPI)
  target_link_libraries(distributed_mpi PRIVATE MPI::MPI_C)
  list(APPEND distributed distributed_mpi)
endif()
foreach(name ${distributed})
  set_target_properties(${name} PROPERTIES C_STANDARD 11)
  target_link_libraries(${name} PRIVATE m)
  rdm_example(${name})
endforeach()

# Policies that are there a second after the build, where an installed tool has them too.
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/share/redman)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/examples/policies ${PROJECT_BINARY_DIR}/share/redman/policies SYMBOLIC)

# rdm_carry(out tag NAME|NAME_WE files...): a row {"name", R"tag(text)tag"} of a C++ table for each file.
function(rdm_carry out tag part)
  set(rows "")
  foreach(file ${ARGN})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    get_filename_component(name ${file} ${part})
    file(READ ${file} text)
    string(APPEND rows "    {\"${name}\", R\"${tag}(${text})${tag}\"},\n")
  endforeach()
  set(${out} "${rows}" PARENT_SCOPE)
endfunction()

file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/examples/redman/*.cpp)
if(sources AND NOT REDMAN_TOOL STREQUAL "OFF" AND NOT RDM_TOOL_MISSING)
  # The tool carries the demonstrations.
  file(GLOB demos CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/examples/demos/*.demo)
  rdm_carry(RDM_DEMOS demo NAME_WE ${demos})
  file(CONFIGURE OUTPUT demos.cpp @ONLY CONTENT "#include \"demo/script.hpp\"
namespace tool {
const CarriedDemo kCarriedDemos[] = {
@RDM_DEMOS@    {nullptr, nullptr},
};
}
")
  # And the pages it makes, with the library that draws them: npm's or Debian's three, one minified classic script.
  find_file(RDM_THREE three.min.js NO_DEFAULT_PATH PATHS ${CMAKE_CURRENT_BINARY_DIR}/viewers/node_modules/three/build
            /usr/share/javascript/three)
  set(three "${RDM_THREE}")
  if(NOT REDMAN_VIEWER STREQUAL "AUTO")
    set(three "${REDMAN_VIEWER}")
  endif()
  file(GLOB pages CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/examples/redman/web/*.html
       ${PROJECT_SOURCE_DIR}/examples/redman/web/*.js ${PROJECT_SOURCE_DIR}/examples/redman/web/*.css
       ${PROJECT_SOURCE_DIR}/examples/redman/web/*.txt)
  set(RDM_WEB "")
  if(three)
    if(NOT EXISTS "${three}")
      message(FATAL_ERROR "REDMAN_VIEWER=${REDMAN_VIEWER}: no such file; give AUTO, OFF or a three.min.js (Debian: libjs-three)")
    endif()
    set(RDM_VIEWER "${three}")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${three})
    file(READ "${three}" text)
    string(APPEND RDM_WEB "    {\"three\", R\"web(${text})web\"},\n")
  endif()
  rdm_carry(carried web NAME ${pages})
  string(APPEND RDM_WEB "${carried}")
  set(web ${CMAKE_CURRENT_BINARY_DIR}/web_assets.cpp)
  file(WRITE ${web}.new "#include \"web/page.hpp\"
namespace tool {
const WebAsset kWebAssets[] = {
${RDM_WEB}    {nullptr, nullptr},
};
}
")
  file(COPY_FILE ${web}.new ${web} ONLY_IF_DIFFERENT)
  # Everything but main is a library too, for tests of its parsers.
  list(REMOVE_ITEM sources ${PROJECT_SOURCE_DIR}/examples/redman/main.cpp)
  add_library(redman_tool_parts STATIC ${sources} ${CMAKE_CURRENT_BINARY_DIR}/demos.cpp ${web})
  target_include_directories(redman_tool_parts PUBLIC ${PROJECT_SOURCE_DIR}/examples/redman)
  if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
    target_sources(redman_tool_parts PRIVATE ${RDM_DISTRIBUTED}/fork_ranks.c)
  endif()
  if(REDMAN_MPI)
    add_library(redman_mpi_ranks STATIC ${RDM_DISTRIBUTED}/mpi_ranks.c)  # apart: others need none of MPI's flags
    target_link_libraries(redman_mpi_ranks PRIVATE MPI::MPI_C)
    rdm_example(redman_mpi_ranks)
    set_source_files_properties(${PROJECT_SOURCE_DIR}/examples/redman/run/ranks.cpp PROPERTIES COMPILE_DEFINITIONS REDMAN_MPI=1)
    target_link_libraries(redman_tool_parts PRIVATE redman_mpi_ranks)
  endif()
  target_link_libraries(redman_tool_parts PUBLIC CLI11::CLI11 nlohmann_json::nlohmann_json PNG::PNG ZLIB::ZLIB ${CMAKE_DL_LIBS})
  if(WIN32)
    target_compile_definitions(redman_tool_parts PUBLIC _FILE_OFFSET_BITS=64 _USE_MATH_DEFINES)
    target_link_options(redman_tool_parts PUBLIC -static)
    target_link_libraries(redman_tool_parts PUBLIC ws2_32 shell32)
  endif()
  if(TARGET Qhull::qhull_r)
    target_compile_definitions(redman_tool_parts PRIVATE REDMAN_QHULL=1)
    target_link_libraries(redman_tool_parts PUBLIC Qhull::qhull_r)
  endif()
  if(RDM_HACD_INCLUDE AND RDM_HACD_LIBRARY AND NOT REDMAN_HACD STREQUAL "OFF")
    set_source_files_properties(${PROJECT_SOURCE_DIR}/examples/redman/mesh/parts.cpp PROPERTIES
      COMPILE_DEFINITIONS REDMAN_HACD=1 COMPILE_OPTIONS "-isystem;${RDM_HACD_INCLUDE}")
    target_link_libraries(redman_tool_parts PUBLIC ${RDM_HACD_LIBRARY})
  endif()
  if(TARGET redman_import_static)
    target_compile_definitions(redman_tool_parts PRIVATE REDMAN_IMPORT=1)
    target_link_libraries(redman_tool_parts PUBLIC redman_import$<$<NOT:$<BOOL:${REDMAN_SHARED}>>:_static>)
  endif()
  target_link_libraries(redman_tool_parts PUBLIC $<IF:$<BOOL:${REDMAN_SHARED}>,redman,redman_static>)
  add_executable(redman_tool ${PROJECT_SOURCE_DIR}/examples/redman/main.cpp)
  target_link_libraries(redman_tool PRIVATE redman_tool_parts)
  set_target_properties(redman_tool PROPERTIES OUTPUT_NAME redman)
  # CLI11 and json take most of the time that a file takes: six share it, and more where none is edited.
  set(files_together 6)
  if(RDM_UNITY)
    set(files_together 21)
  endif()
  set_target_properties(redman_tool_parts PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${files_together})
  # asks for functions before it includes a header
  set_source_files_properties(${PROJECT_SOURCE_DIR}/examples/redman/common/posix_windows.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  foreach(target redman_tool_parts redman_tool)
    set_target_properties(${target} PROPERTIES CXX_STANDARD 20)
    rdm_example(${target})
    target_compile_options(${target} PRIVATE -O1)  # its time goes by in the library; half the time to build
  endforeach()
endif()
