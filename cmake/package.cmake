# What packages carry beside install.cmake: manual, completions, examples, the Python package; and `cpack -G DEB` of
# preset `package`, which makes libredman<ABI>, libredman-dev, redman, redman-doc and python3-redman.
set(REDMAN_PYTHON_DIR "" CACHE STRING "Where below the prefix the Python package goes, \"\": it is not installed")
set(REDMAN_CONTACT "redman maintainers <maintainers@redman.example>" CACHE STRING "Maintainer in the .deb files")
if(TARGET manual)
  install(DIRECTORY ${RDM_MANUAL}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT tools OPTIONAL)
  install(FILES ${RDM_MANUAL}/bash/redman COMPONENT tools
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(FILES ${RDM_MANUAL}/zsh/_redman DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT tools)
  install(FILES ${RDM_MANUAL}/fish/redman.fish COMPONENT tools
          DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
  install(DIRECTORY examples/demos DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT tools PATTERN README.md EXCLUDE)
endif()
if(TARGET redman_tool)
  install(DIRECTORY examples/policies DESTINATION ${CMAKE_INSTALL_DATADIR}/redman COMPONENT tools
          FILES_MATCHING PATTERN *.rdm)
endif()
if(REDMAN_STUBS OR REDMAN_SIM OR REDMAN_LEARN)
  file(GLOB sources CONFIGURE_DEPENDS examples/[0-9]*.c examples/[0-9]*.cpp)
  # The manual and what its pages link to, with links that lead there: written when it is installed.
  set(pages ${PROJECT_BINARY_DIR}/pages)
  file(RELATIVE_PATH headers ${CMAKE_INSTALL_FULL_DOCDIR} ${CMAKE_INSTALL_FULL_INCLUDEDIR})
  install(CODE "execute_process(COMMAND sh \"${PROJECT_SOURCE_DIR}/cmake/packaging/pages.sh\" \"${PROJECT_SOURCE_DIR}\" \"${pages}\" ${headers}
                                COMMAND_ERROR_IS_FATAL ANY)" COMPONENT doc)
  install(DIRECTORY ${pages}/ DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT doc)
else()  # they call what this build may not have
  set(sources examples/small/act.c examples/small/peak.h)
endif()
install(FILES ${sources} DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT dev)
if(REDMAN_PYTHON_DIR)
  install(DIRECTORY capi/python/redman DESTINATION ${REDMAN_PYTHON_DIR} COMPONENT python
          FILES_MATCHING PATTERN *.py PATTERN py.typed PATTERN __pycache__ EXCLUDE)
endif()
if(NOT PROJECT_IS_TOP_LEVEL)
  return()
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "${REDMAN_CONTACT}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # every package has its own
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL runtime dev tools doc)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/packaging/debian/finish.cmake)
set(RDM_DEBIAN ${PROJECT_BINARY_DIR}/debian)
set(library libredman${RDM_ABI})
math(EXPR next "${PROJECT_VERSION_MINOR} + 1")
set(next ${PROJECT_VERSION_MAJOR}.${next})

# rdm_deb(component package section SUMMARY text DEPENDS list TEXT long description)
function(rdm_deb component package section)
  cmake_parse_arguments(arg "" "SUMMARY;DEPENDS;TEXT" "CONTROL" ${ARGN})
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${arg_DEPENDS}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${arg_SUMMARY}\n${arg_TEXT}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_CONTROL_EXTRA "${arg_CONTROL}" PARENT_SCOPE)
endfunction()
set(text "Two 24-joint hands throw, catch, grasp and use things in worlds that\nare stepped together, ten safe learners act \
on rewards and costs, and\na frozen policy runs on a machine that has nothing else. The same\nseed gives the same bytes for any \
number of threads.")
rdm_deb(runtime ${library} libs SUMMARY "safe dexterous manipulation (shared library)" TEXT "${text}"
        CONTROL ${RDM_DEBIAN}/symbols ${RDM_DEBIAN}/shlibs ${RDM_DEBIAN}/triggers)
rdm_deb(dev libredman-dev libdevel SUMMARY "safe dexterous manipulation (headers, static library)" TEXT "${text}\n.\nThis \
package is for those who build programs against it."
        DEPENDS "${library} (= ${PROJECT_VERSION}), libode-dev, libccd-dev, liboctomap-dev")
rdm_deb(tools redman science SUMMARY "train, evaluate and look at safe dexterous manipulation" TEXT "${text}\n.\nThis package \
holds the command-line tool, its manual and\nits scripted demonstrations."
        DEPENDS "${library} (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DOC_PACKAGE_ARCHITECTURE all)
rdm_deb(doc redman-doc doc SUMMARY "safe dexterous manipulation (manual)" TEXT "${text}\n.\nThis package holds the manual: pages of \
Markdown in\n/usr/share/doc/redman/manual, with the pictures and results that they show.")
if(TARGET redman_import)
  set(import libredman-import${RDM_ABI})
  list(APPEND CPACK_COMPONENTS_ALL import)
  rdm_deb(import ${import} libs SUMMARY "safe dexterous manipulation (robots out of files)" TEXT "${text}\n.\nThis package \
holds the library that reads robots: URDF, MJCF\nand redman's own text."
          DEPENDS "${library} (= ${PROJECT_VERSION})" CONTROL ${RDM_DEBIAN}/import/shlibs ${RDM_DEBIAN}/triggers)
  string(APPEND CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS ", ${import} (= ${PROJECT_VERSION})")
  string(APPEND CPACK_DEBIAN_DEV_PACKAGE_DEPENDS ", ${import} (= ${PROJECT_VERSION}), libtinyxml2-dev")
  file(WRITE ${RDM_DEBIAN}/import/shlibs "libredman_import ${RDM_ABI} ${import} (>= ${PROJECT_VERSION})\n")
endif()
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS "ffmpeg, redman-doc")  # films
if(REDMAN_PYTHON_DIR)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
  rdm_deb(python python3-redman python SUMMARY "safe dexterous manipulation (Python 3)" TEXT "${text}\n.\nThis package holds \
the Python module, with environments for\nGymnasium and its like."
          DEPENDS "${library} (>= ${PROJECT_VERSION}), ${library} (<< ${next}~), python3:any (>= 3.9~), python3-numpy"
          CONTROL ${PROJECT_SOURCE_DIR}/cmake/packaging/debian/postinst ${PROJECT_SOURCE_DIR}/cmake/packaging/debian/prerm)
  if(TARGET redman_import)
    set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "${import} (>= ${PROJECT_VERSION}), ${import} (<< ${next}~)")  # files of one's own
  endif()
endif()
set(CPACK_DEBIAN_TOOLS_PACKAGE_SHLIBDEPS ON)  # those of the libraries: finish.cmake

# What the library promises to programs, and that the loader's cache must know it.
file(WRITE ${RDM_DEBIAN}/shlibs "libredman ${RDM_ABI} ${library} (>= ${PROJECT_VERSION})\n")
file(WRITE ${RDM_DEBIAN}/triggers "activate-noawait ldconfig\n")
include(CPack)
