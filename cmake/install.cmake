# SPDX-License-Identifier: Apache-2.0
# The installed tree: libraries, headers, data, and files for CMake and pkg-config. It contains no absolute path, so it can be
# moved as a whole.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/petzval)
set(pkgconfig_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH pc_libdir ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_FULL_LIBDIR})
file(RELATIVE_PATH pc_datadir ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_FULL_DATADIR}/petzval)
file(RELATIVE_PATH pc_includedir ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_FULL_INCLUDEDIR})

# petzval_install(image DESCRIPTION "..." STATIC_REQUIRES OpenEXR): installs one component if it was built.
# Each component has its own export set, so that a program that uses core does not need the libraries of other components.
# REQUIRES, STATIC_REQUIRES, STATIC_LIBS: other libraries that users link, named as in pkg-config. In the .pc file and in
# petzvalConfig.cmake, publicly linked components precede these. NEEDS: components that a static library links privately.
function(petzval_install component)
  cmake_parse_arguments(PARSE_ARGV 1 pc "" "DESCRIPTION;REQUIRES;STATIC_REQUIRES;STATIC_LIBS" "NEEDS")
  set(name petzval-${component})
  if(NOT TARGET ${name})
    return()
  endif()
  install(TARGETS ${name} EXPORT ${name} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(EXPORT ${name} NAMESPACE petzval:: FILE ${name}-targets.cmake DESTINATION ${package_dir})

  get_target_property(type ${name} TYPE)
  if(type STREQUAL SHARED_LIBRARY)  # a shared library has already linked these
    set(pc_STATIC_REQUIRES "")
    set(pc_STATIC_LIBS "")
    set(pc_NEEDS "")
  endif()
  get_target_property(needs ${name} INTERFACE_LINK_LIBRARIES)
  list(FILTER needs INCLUDE REGEX "^petzval::")
  list(TRANSFORM needs REPLACE "^petzval::" "")
  foreach(need IN LISTS pc_NEEDS)
    if(TARGET petzval-${need})
      list(APPEND needs ${need})
    endif()
  endforeach()
  string(APPEND component_needs "set(petzval_${component}_needs ${needs})\n")
  set(component_needs "${component_needs}" PARENT_SCOPE)
  list(TRANSFORM needs PREPEND petzval-)
  list(JOIN needs ", " pc_needs)
  string(JOIN ", " pc_REQUIRES ${pc_needs} ${pc_REQUIRES})

  set(built_components ${built_components} ${component} PARENT_SCOPE)
  if(type STREQUAL STATIC_LIBRARY AND component STREQUAL "fit")  # Ceres has no .pc file to require
    return()
  endif()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/petzval.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${pkgconfig_dir})
endfunction()

petzval_install(core DESCRIPTION "Real lenses for renderers: prescriptions, ray tracing, pupils, focus, cameras"
  REQUIRES glm STATIC_LIBS -ldl)
petzval_install(analysis DESCRIPTION "Spots, point spread functions, colour and errors of lenses")
petzval_install(blur DESCRIPTION "Lens blur of layered pictures")
petzval_install(exports DESCRIPTION "Lenses and cameras for other programs: calibrations, distortion, ray maps, shaders")
petzval_install(figure DESCRIPTION "SVG figures of lenses")
petzval_install(fit DESCRIPTION "Least-squares fits for lens optics")
get_target_property(formats_links petzval-formats LINK_LIBRARIES)
set(formats_yaml "")
if("yaml-cpp" IN_LIST formats_links)
  set(formats_yaml yaml-cpp)
endif()
petzval_install(formats DESCRIPTION "Lenses and glasses in files of other programs" STATIC_REQUIRES "${formats_yaml}")
petzval_install(image DESCRIPTION "EXR and PNG images" STATIC_REQUIRES "OpenEXR libpng")
petzval_install(c DESCRIPTION "Lenses and cameras for renderers, in C and any C++" NEEDS core analysis blur formats)

get_target_property(core_type petzval-core TYPE)
configure_package_config_file(cmake/petzvalConfig.cmake.in petzvalConfig.cmake INSTALL_DESTINATION ${package_dir}
  PATH_VARS CMAKE_INSTALL_DATADIR NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(petzvalConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/petzvalConfig.cmake ${PROJECT_BINARY_DIR}/petzvalConfigVersion.cmake
  DESTINATION ${package_dir})

install(DIRECTORY data/ DESTINATION ${CMAKE_INSTALL_DATADIR}/petzval)
install(FILES LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
# The guides keep their folders, which their links name.
install(DIRECTORY lib/docs DESTINATION ${CMAKE_INSTALL_DOCDIR}/lib FILES_MATCHING PATTERN "*.md")
install(DIRECTORY examples/pictures DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)
install(FILES examples/hosts/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples/hosts)
