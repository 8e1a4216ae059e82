# Debian packages, by cpack (deploy/packages): palpate, palpate-viewer, libpalpate0, libpalpate-dev, python3-palpate.
# A package is a group of components; `cmake --install BUILD --component NAME` installs one of them.

# help2man makes manual pages from the --help of the built programs, one for each program and verb.
find_program(PALPATE_HELP2MAN help2man)
set(manual ${CMAKE_BINARY_DIR}/manual)
add_custom_target(manual
  COMMAND ${CMAKE_SOURCE_DIR}/deploy/manual_pages $<TARGET_FILE_DIR:palpate> ${manual}
  DEPENDS palpate palpate-scheduler palpate-worker palpate-viewer palpate-answers palpate-verify VERBATIM)
install(DIRECTORY ${manual}/palpate/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT manual OPTIONAL)
install(DIRECTORY ${manual}/palpate-viewer/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT viewer OPTIONAL)
install(FILES deploy/completions/palpate DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT manual)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME palpate)
set(CPACK_PACKAGE_VENDOR "The Palpate authors")
set(CPACK_PACKAGE_CONTACT "The Palpate authors <palpate@localhost>")
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR}/lib)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# Files that Debian requires in every package.
set(debian ${CMAKE_BINARY_DIR}/debian)
file(MAKE_DIRECTORY ${debian})
execute_process(COMMAND gzip -9nc ${CMAKE_SOURCE_DIR}/deploy/debian/changelog OUTPUT_FILE ${debian}/changelog.gz COMMAND_ERROR_IS_FATAL ANY)

# palpate_package(NAME COMPONENTS... SECTION word [ARCHITECTURE all] [DEPENDS text] [RECOMMENDS text] [SUGGESTS text]
#                 [OVERRIDE text for lintian] SUMMARY text DESCRIPTION text)
function(palpate_package name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "SECTION;ARCHITECTURE;DEPENDS;RECOMMENDS;SUGGESTS;REPLACES;OVERRIDE;SUMMARY;DESCRIPTION" "COMPONENTS")
  string(MAKE_C_IDENTIFIER ${name} group)
  string(TOUPPER ${group} upper)
  install(FILES deploy/debian/copyright ${debian}/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name}
    COMPONENT debian-${name} EXCLUDE_FROM_ALL)
  configure_file(deploy/debian/overrides.in ${debian}/overrides-${name} @ONLY)
  install(FILES ${debian}/overrides-${name} DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides RENAME ${name}
    COMPONENT debian-${name} EXCLUDE_FROM_ALL)
  foreach(component ${arg_COMPONENTS} debian-${name})
    set_property(GLOBAL APPEND PROPERTY palpate_packaged ${component}=${group})
  endforeach()
  foreach(word SECTION DEPENDS RECOMMENDS SUGGESTS REPLACES ARCHITECTURE)
    if(arg_${word})
      set(CPACK_DEBIAN_${upper}_PACKAGE_${word} "${arg_${word}}" PARENT_SCOPE)
    endif()
  endforeach()
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${arg_SUMMARY}\n${arg_DESCRIPTION}" PARENT_SCOPE)
endfunction()

palpate_package(palpate COMPONENTS service live verification manual documents data SECTION science
  REPLACES palpate-viewer  # whose earlier versions had the manual pages of query, report, share and export
  RECOMMENDS "palpate-viewer (= ${PROJECT_VERSION}), gmsh" SUGGESTS "python3-palpate, python3-meshio, tetgen, slurm-client, bash-completion"
  SUMMARY "feel a nonlinear soft body at 1 kHz"
  DESCRIPTION "A scheduler and workers precompute equilibria of a soft body, by finite
elements, for a lattice of displacements of a finger on its surface. Forces
in between are interpolated, with an error bound.
.
This package has the programs that check scenes, build datasets on one machine
or many, and use the datasets: queries, reports and touchable web pages.")
palpate_package(palpate-viewer COMPONENTS viewer SECTION science
  DEPENDS "palpate (= ${PROJECT_VERSION}), fonts-roboto-unhinted"
  SUMMARY "feel a nonlinear soft body at 1 kHz: client"
  DESCRIPTION "The haptic client of Palpate: contact, force guard, devices and the
picture.")
palpate_package(libpalpate0 COMPONENTS library SECTION libs
  OVERRIDE "# cpack writes these calls beside the trigger.\nlibpalpate0: maintscript-calls-ldconfig *\n"
  SUMMARY "forces of a nonlinear soft body: library"
  DESCRIPTION "A C library for simulators with a loop of their own. It answers queries
from datasets of Palpate: force, stiffness, energy and error bound. It also
has the contact of a tool, and a force guard for haptic devices.")
palpate_package(libpalpate-dev COMPONENTS development SECTION libdevel DEPENDS "libpalpate0 (= ${PROJECT_VERSION})"
  SUMMARY "forces of a nonlinear soft body: development files"
  DESCRIPTION "Headers of libpalpate and of plug-ins for haptic devices, files for
CMake and pkg-config, and examples in C, C++, C# and Python.")
palpate_package(python3-palpate COMPONENTS python SECTION python ARCHITECTURE all
  DEPENDS "python3, python3-numpy, libpalpate0 (= ${PROJECT_VERSION})" RECOMMENDS "python3-h5py"
  SUMMARY "forces of a nonlinear soft body: Python 3 package"
  DESCRIPTION "Datasets of Palpate as NumPy arrays, thousands of queries in one call,
and contact of a tool.")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_DEBIAN_PYTHON3_PALPATE_PACKAGE_SHLIBDEPS OFF)
# Programs that link libpalpate depend on libpalpate0. A trigger tells the system about the library.
file(WRITE ${debian}/shlibs "libpalpate 0 libpalpate0 (>= ${PROJECT_VERSION})\n")
file(WRITE ${debian}/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBPALPATE0_PACKAGE_CONTROL_EXTRA ${debian}/shlibs ${debian}/triggers)

get_property(packaged GLOBAL PROPERTY palpate_packaged)
list(TRANSFORM packaged REPLACE "=.*" "" OUTPUT_VARIABLE CPACK_COMPONENTS_ALL)
include(CPack)
foreach(pair ${packaged})
  string(REGEX MATCH "^(.*)=(.*)$" _ ${pair})
  cpack_add_component(${CMAKE_MATCH_1} GROUP ${CMAKE_MATCH_2})
endforeach()
