# Target `reference`: the headers' comments as HTML in build/<preset>/reference/html, by Doxygen. Its warnings are errors, and what is
# declared without a comment is a warning. Target `docs`: the site in build/<preset>/site/html, that reference and every page in it; without
# Sphinx, MyST and Furo (Debian: python3-sphinx python3-myst-parser furo) it is the reference alone.
find_program(RDM_DOXYGEN doxygen)
if(NOT RDM_DOXYGEN)
  return()
endif()
set(RDM_REFERENCE ${CMAKE_CURRENT_BINARY_DIR}/reference)
configure_file(cmake/packaging/Doxyfile.in ${RDM_REFERENCE}/Doxyfile @ONLY)
add_custom_target(reference VERBATIM COMMENT "Reference of the C interface: ${RDM_REFERENCE}/html/index.html"
  COMMAND ${RDM_DOXYGEN} ${RDM_REFERENCE}/Doxyfile
  COMMAND sh ${PROJECT_SOURCE_DIR}/cmake/packaging/reference.sh ${PROJECT_SOURCE_DIR} ${RDM_REFERENCE})
if(NOT REDMAN_SHARED)  # Python's reference loads it
  return()
endif()
add_custom_target(docs VERBATIM COMMAND sh ${PROJECT_SOURCE_DIR}/cmake/packaging/site/site.sh ${PROJECT_SOURCE_DIR}
  ${CMAKE_CURRENT_BINARY_DIR} ${PROJECT_VERSION} $<TARGET_FILE:redman>)
add_dependencies(docs reference redman)
