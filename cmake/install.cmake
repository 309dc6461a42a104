include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS hyperiso hyperiso_compiler EXPORT hyperiso-targets)
install(DIRECTORY include/hyperiso DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
