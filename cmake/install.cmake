# What `cmake --install` lays down: the program, the library with its headers, and the files that make
# find_package(hyperiso) work. tests/install is a project that uses them.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/hyperiso)

install(TARGETS hyperiso EXPORT hyperiso-targets
  ARCHIVE COMPONENT library
  LIBRARY COMPONENT library
  RUNTIME COMPONENT library)
install(DIRECTORY include/hyperiso DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library)
install(EXPORT hyperiso-targets NAMESPACE hyperiso:: DESTINATION ${package_dir} COMPONENT library)

configure_package_config_file(cmake/hyperiso-config.cmake.in hyperiso-config.cmake
  INSTALL_DESTINATION ${package_dir} NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(hyperiso-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES
  ${CMAKE_CURRENT_BINARY_DIR}/hyperiso-config.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/hyperiso-config-version.cmake
  DESTINATION ${package_dir} COMPONENT library)

if(TARGET hyperiso_cli)
  file(RELATIVE_PATH library_dir /${CMAKE_INSTALL_BINDIR} /${CMAKE_INSTALL_LIBDIR})
  set_target_properties(hyperiso_cli PROPERTIES INSTALL_RPATH $ORIGIN/${library_dir}) # of a shared library
  install(TARGETS hyperiso_cli COMPONENT program)
endif()
