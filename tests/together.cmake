# Many test files as few: what a test costs to build is mostly the headers that it includes.
#
# rdm_join writes a folder's files into a handful of sources. Each of these includes the headers of its files first and then
# the files, each within a namespace of its own, in which rdm, rdm::test, rdm::capi and tool are the library's: two files may have
# helpers of one name, as they may in programs of their own. A file with other lines of the preprocessor than #include and
# RDM_EXPERIMENTAL stays a source of its own.

set(RDM_JOINED 12)  # files in one source, at most
# GCC takes a fixture of an unnamed namespace for one that others include, since the file is included itself.
set(RDM_JOINED_HEAD [[
#define RDM_EXPERIMENTAL
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wsubobject-linkage"
#endif]])

# The #include lines of a file, and whether it has no others of the preprocessor.
function(rdm_headers_of source headers plain)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})
  file(STRINGS ${source} lines REGEX "^[ ]*#")
  set(found "")
  set(only TRUE)
  foreach(line ${lines})
    if(line MATCHES "^#include [<\"].*[.]inl\"" OR NOT line MATCHES "^#include|^#define RDM_EXPERIMENTAL$")
      set(only FALSE)
    elseif(line MATCHES "^#include")
      list(APPEND found ${line})
    endif()
  endforeach()
  set(${headers} "${found}" PARENT_SCOPE)
  set(${plain} ${only} PARENT_SCOPE)
endfunction()

function(rdm_includes source pattern out)
  file(STRINGS ${source} lines REGEX "^#include.*${pattern}")
  set(${out} FALSE PARENT_SCOPE)
  if(lines)
    set(${out} TRUE PARENT_SCOPE)
  endif()
endfunction()

# A program of its own: one that stands in front of operator new, those whose rows other machines write.
function(rdm_stands_alone source out)
  rdm_includes(${source} "refuse_new.hpp" alone)
  if(source MATCHES "/test_golden")
    set(alone TRUE)
  endif()
  set(${out} ${alone} PARENT_SCOPE)
endfunction()

function(rdm_counts_heap source out)
  rdm_includes(${source} "heap_count.hpp" counts)
  set(${out} ${counts} PARENT_SCOPE)
endfunction()

# A filter of GoogleTest for the suites of a file: those of TEST and TEST_F, with parameters, and of types.
function(rdm_suites_of source list out)
  file(STRINGS ${source} lines REGEX "^(TEST|TEST_F|TEST_P|TYPED_TEST)\\(")
  set(suites "")
  foreach(line ${lines})
    string(REGEX REPLACE "^[A-Z_]+\\(([A-Za-z0-9_]+).*" "\\1" suite ${line})
    list(APPEND suites ${suite})
  endforeach()
  list(REMOVE_DUPLICATES suites)
  set(${list} "${suites}" PARENT_SCOPE)
  set(filter "")
  foreach(suite ${suites})
    string(APPEND filter ":${suite}.*:*/${suite}.*:${suite}/*")
  endforeach()
  string(REGEX REPLACE "^:" "" filter "${filter}")
  set(${out} "${filter}" PARENT_SCOPE)
endfunction()

function(rdm_join program files out)
  set(joined "")
  set(part "")
  set(number 0)
  foreach(file ${files})
    rdm_headers_of(${file} headers plain)
    if(NOT plain)
      list(APPEND joined ${file})
      continue()
    endif()
    list(APPEND part ${file})
    list(LENGTH part length)
    if(length EQUAL RDM_JOINED)
      rdm_write_joined(${program}_${number} "${part}" source)
      list(APPEND joined ${source})
      set(part "")
      math(EXPR number "${number} + 1")
    endif()
  endforeach()
  if(part)
    rdm_write_joined(${program}_${number} "${part}" source)
    list(APPEND joined ${source})
  endif()
  set(${out} "${joined}" PARENT_SCOPE)
endfunction()

function(rdm_write_joined name files out)
  set(headers "")
  set(bodies "")
  foreach(file ${files})
    rdm_headers_of(${file} of_file plain)
    list(APPEND headers ${of_file})
    get_filename_component(noun ${file} NAME_WE)
    string(APPEND bodies "\nnamespace of_${noun} {\nnamespace rdm {\nusing namespace ::rdm;\n"
      "namespace test {\nusing namespace ::rdm::test;\n}\nnamespace capi {\nusing namespace ::rdm::capi;\n}\n}\nnamespace tool {\nusing namespace ::tool;\n}\n#include \"${file}\"\n}\n")
  endforeach()
  list(REMOVE_DUPLICATES headers)
  list(JOIN headers "\n" headers)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "${RDM_JOINED_HEAD}\n${headers}\n#include <gtest/gtest.h>\nnamespace rdm {\nnamespace test {}\nnamespace capi {}\n}\nnamespace tool {}\n${bodies}" @ONLY)
  set(${out} ${source} PARENT_SCOPE)
endfunction()
