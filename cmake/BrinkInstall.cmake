# Installation, and the package files that make find_package(brink) work.
include(CMakePackageConfigHelpers)

get_property(rooms GLOBAL PROPERTY BRINK_ROOMS)
install(TARGETS ${rooms} EXPORT brinkTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(room core integrators scheduler scenes)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${room} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/brink
    FILES_MATCHING PATTERN "*.h" PATTERN gallery EXCLUDE)
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes/gallery DESTINATION ${CMAKE_INSTALL_DATADIR}/brink)
install(EXPORT brinkTargets NAMESPACE brink:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/brink)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/brinkConfig.cmake.in
  ${PROJECT_BINARY_DIR}/brinkConfig.cmake INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/brink)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/brinkConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/brinkConfig.cmake ${PROJECT_BINARY_DIR}/brinkConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/brink)
