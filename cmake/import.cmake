# redman_import: robots out of files, on the public headers and on lib/base, whose objects it carries. The shared one stands
# on libredman.so; the static one takes whichever redman the program links behind it.
if(NOT REDMAN_SIM OR REDMAN_IMPORT STREQUAL "OFF" OR RDM_IMPORT_MISSING)
  return()
endif()
file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/capi/import/*.cpp)
add_library(rdm_import OBJECT ${sources})
target_include_directories(rdm_import PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/lib)
target_include_directories(rdm_import SYSTEM PRIVATE ${RDM_TOML})
target_link_libraries(rdm_import PRIVATE rdm_flags tinyxml2::tinyxml2)
target_compile_options(rdm_import PRIVATE -O2)  # a file is read once: half the time to build
if(WIN32)
  target_compile_definitions(rdm_import PRIVATE _USE_MATH_DEFINES)  # M_PI, which other systems have anyway
endif()
set_target_properties(rdm_import PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden
                      VISIBILITY_INLINES_HIDDEN ON)

function(rdm_import_library target kind)
  add_library(${target} ${kind})
  add_library(redman::${target} ALIAS ${target})
  target_sources(${target} PRIVATE $<TARGET_OBJECTS:rdm_import> $<TARGET_OBJECTS:rdm_base>)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                             $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  set_target_properties(${target} PROPERTIES OUTPUT_NAME redman_import LINKER_LANGUAGE CXX
                        VERSION ${PROJECT_VERSION} SOVERSION ${RDM_ABI})
  if(REDMAN_COVERAGE)
    target_link_options(${target} PUBLIC --coverage)
  endif()
  if(REDMAN_SANITIZE)
    target_link_options(${target} PUBLIC -fsanitize=${REDMAN_SANITIZE})
  endif()
endfunction()
rdm_import_library(redman_import_static STATIC)
rdm_archive(redman_import_static)
target_link_libraries(redman_import_static PRIVATE tinyxml2::tinyxml2 Threads::Threads)
if(REDMAN_SHARED)
  rdm_import_library(redman_import SHARED)
  target_link_libraries(redman_import PUBLIC redman PRIVATE tinyxml2::tinyxml2 Threads::Threads)
  rdm_export(redman_import
             import/redman_import:REDMAN_IMPORT_EXPERIMENTAL_${RDM_VERSION_MAJOR}_${RDM_VERSION_MINOR})
endif()
