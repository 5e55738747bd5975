# Target `docs`: the header's comments as HTML in build/<preset>/reference/html, by Doxygen. Its warnings are errors, and what is
# declared without a comment is a warning.
find_program(RDM_DOXYGEN doxygen)
if(NOT RDM_DOXYGEN)
  return()
endif()
set(RDM_REFERENCE ${CMAKE_CURRENT_BINARY_DIR}/reference)
configure_file(cmake/packaging/Doxyfile.in ${RDM_REFERENCE}/Doxyfile @ONLY)
add_custom_target(docs VERBATIM COMMENT "Reference of the C interface: ${RDM_REFERENCE}/html/index.html"
  COMMAND ${RDM_DOXYGEN} ${RDM_REFERENCE}/Doxyfile
  COMMAND sh ${PROJECT_SOURCE_DIR}/cmake/packaging/reference.sh ${PROJECT_SOURCE_DIR} ${RDM_REFERENCE})
