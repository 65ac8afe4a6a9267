# Installation, and the package files that make find_package(brink) work.
include(CMakePackageConfigHelpers)

get_property(rooms GLOBAL PROPERTY BRINK_ROOMS)
install(TARGETS ${rooms} EXPORT brinkTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
# What a program may include: these, and what they include in turn. No other header is installed.
set(pending core/base/error.h core/base/random.h core/query/cast_outline.h core/query/cast_ray.h core/query/closest_point.h
  core/query/outline_gap.h core/shapes/shapes.h core/shapes/svg_path.h core/world/forces.h
  core/world/make_body.h scheduler/policies/order.h scheduler/policies/policy.h scheduler/simulator/simulator.h
  scenes/draw/draw.h scenes/run_file/run_file.h scenes/run_file/run_scene.h scenes/scene/scene.h scenes/view/replay_page.h)
set(headers)
while(pending)
  list(POP_FRONT pending header)
  if(header IN_LIST headers)
    continue()
  endif()
  list(APPEND headers ${header})
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES ${PROJECT_SOURCE_DIR}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/brink/${folder})
  file(STRINGS ${PROJECT_SOURCE_DIR}/${header} includes REGEX "^#include \"brink/")
  foreach(line IN LISTS includes)
    string(REGEX REPLACE "^#include \"brink/([^\"]+)\".*" "\\1" included "${line}")
    list(APPEND pending ${included})
  endforeach()
endwhile()
list(SORT headers)
list(JOIN headers "\n" lines)
file(WRITE ${PROJECT_BINARY_DIR}/public_headers.txt "${lines}\n")  # for tests/gates.sh
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes/gallery DESTINATION ${CMAKE_INSTALL_DATADIR}/brink)
install(EXPORT brinkTargets NAMESPACE brink:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/brink)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/brinkConfig.cmake.in
  ${PROJECT_BINARY_DIR}/brinkConfig.cmake INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/brink)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/brinkConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/brinkConfig.cmake ${PROJECT_BINARY_DIR}/brinkConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/brink)
