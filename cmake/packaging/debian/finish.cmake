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

file(WRITE ${stage}/debian/control "")
execute_process(COMMAND dpkg-shlibdeps -O ${library} WORKING_DIRECTORY ${stage} OUTPUT_VARIABLE needs
                OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
file(REMOVE_RECURSE ${stage}/debian)
string(REGEX REPLACE ".*Depends=" "" CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS "${needs}")
