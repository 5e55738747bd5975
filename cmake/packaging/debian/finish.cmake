# Run by cpack between staging and packing: what Debian wants in every package (copyright, changelog, compressed
# manual pages) and the symbols file of the library, from what it exports.
set(here ${CMAKE_CURRENT_LIST_DIR})
set(stage ${CPACK_TEMPORARY_DIRECTORY})

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

foreach(component ${CPACK_COMPONENTS_ALL})
  string(TOUPPER ${component} upper)
  set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  set(doc ${stage}/${component}/usr/share/doc/${package})
  configure_file(${here}/copyright ${doc}/copyright COPYONLY)
  configure_file(${here}/changelog ${doc}/changelog COPYONLY)
  file(REMOVE ${stage}/${component}/usr/share/doc/redman/LICENSE)  # the same as copyright says
  file(GLOB pages ${stage}/${component}/usr/share/man/man1/*.1)
  run(gzip -9nf ${doc}/changelog ${pages})
  set(overrides ${here}/${component}.lintian-overrides)
  if(EXISTS ${overrides})
    configure_file(${overrides} ${stage}/${component}/usr/share/lintian/overrides/${package} COPYONLY)
  endif()
endforeach()

file(GLOB archives ${stage}/dev/usr/lib/*/libredman.a)
run(strip --strip-debug --remove-section=.comment --remove-section=.note --enable-deterministic-archives ${archives})
# A stable symbol is promised from the release on that first had it: its ABI dump tells; those of the experimental
# node for this minor version alone.
file(GLOB library ${stage}/runtime/usr/lib/*/libredman.so.${CPACK_PACKAGE_VERSION})
run(sh ${here}/symbols.sh ${library} ${CPACK_DEBIAN_RUNTIME_PACKAGE_NAME} ${CPACK_PACKAGE_VERSION}
    ${here}/../../../capi/abi ${CPACK_PACKAGE_DIRECTORY}/../debian/symbols)

# What the two libraries ask for. Not by cpack, which would add scripts that call ldconfig, where the triggers do.
get_filename_component(libraries ${library} DIRECTORY)
file(WRITE ${stage}/debian/control "")
# needs(variable FILE): the packages of the libraries that it is linked to, but for those of this build
function(needs variable file)
  execute_process(COMMAND dpkg-shlibdeps -O --ignore-missing-info -l${libraries} ${file} WORKING_DIRECTORY ${stage}
                  OUTPUT_VARIABLE out OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX REPLACE ".*Depends=" "" out "${out}")
  set(${variable} "${out}" PARENT_SCOPE)
endfunction()
needs(CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS ${library})
file(GLOB library ${stage}/import/usr/lib/*/libredman_import.so.${CPACK_PACKAGE_VERSION})
if(library)
  needs(own ${library})
  string(APPEND CPACK_DEBIAN_IMPORT_PACKAGE_DEPENDS ", ${own}")
endif()
file(REMOVE_RECURSE ${stage}/debian)
