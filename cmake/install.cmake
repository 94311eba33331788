# SPDX-License-Identifier: Apache-2.0
# The installed tree: libraries and headers, data, and how CMake and pkg-config find them. Nothing in it holds an absolute
# path, so it can be moved as a whole.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/petzval)
set(pkgconfig_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH pc_libdir ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_FULL_LIBDIR})
file(RELATIVE_PATH pc_datadir ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_FULL_DATADIR}/petzval)
file(RELATIVE_PATH pc_includedir ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_FULL_INCLUDEDIR})

# petzval_install(image DESCRIPTION "..." REQUIRES petzval-core STATIC_REQUIRES OpenEXR): one component, where it was built.
# An export set of its own: a program that asks for core never hears of what the others link.
# REQUIRES, STATIC_REQUIRES, STATIC_LIBS: what users link beside it, in pkg-config's words.
function(petzval_install component)
  cmake_parse_arguments(PARSE_ARGV 1 pc "" "DESCRIPTION;REQUIRES;STATIC_REQUIRES;STATIC_LIBS" "")
  set(name petzval-${component})
  if(NOT TARGET ${name})
    return()
  endif()
  install(TARGETS ${name} EXPORT ${name} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(EXPORT ${name} NAMESPACE petzval:: FILE ${name}-targets.cmake DESTINATION ${package_dir})

  get_target_property(type ${name} TYPE)
  if(type STREQUAL SHARED_LIBRARY)  # it has linked them itself
    set(pc_STATIC_REQUIRES "")
    set(pc_STATIC_LIBS "")
  endif()
  set(built_components ${built_components} ${component} PARENT_SCOPE)
  if(type STREQUAL STATIC_LIBRARY AND component STREQUAL "fit")  # Ceres has no .pc file that it could require
    return()
  endif()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/petzval.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${pkgconfig_dir})
endfunction()

petzval_install(core DESCRIPTION "Real lenses for renderers: prescriptions, ray tracing, pupils, focus, point spread functions"
  REQUIRES glm STATIC_REQUIRES yaml-cpp STATIC_LIBS -ldl)
petzval_install(blur DESCRIPTION "Lens blur of layered pictures" REQUIRES petzval-core)
petzval_install(fit DESCRIPTION "Least-squares fits for lens optics" REQUIRES petzval-core)
petzval_install(figure DESCRIPTION "SVG figures of lenses" REQUIRES petzval-core)
petzval_install(image DESCRIPTION "EXR and PNG images" REQUIRES "petzval-core, petzval-blur" STATIC_REQUIRES "OpenEXR libpng")

configure_package_config_file(cmake/petzvalConfig.cmake.in petzvalConfig.cmake INSTALL_DESTINATION ${package_dir}
  PATH_VARS CMAKE_INSTALL_DATADIR NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(petzvalConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/petzvalConfig.cmake ${PROJECT_BINARY_DIR}/petzvalConfigVersion.cmake
  DESTINATION ${package_dir})

install(DIRECTORY data/ DESTINATION ${CMAKE_INSTALL_DATADIR}/petzval)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
