# The package: program, SDK, components (installed by bramah_add_plugin), scenes, CMake files. Paths are relative to the
# prefix and plain lib/, since the program looks for its components relative to itself.
include(CMakePackageConfigHelpers)
set(package_dir lib/cmake/Bramah)

install(TARGETS bramah_abi bramah_sdk EXPORT BramahTargets)
if(TARGET bramah)
  install(TARGETS bramah EXPORT BramahTargets RUNTIME DESTINATION bin)
endif()
install(EXPORT BramahTargets NAMESPACE Bramah:: DESTINATION ${package_dir})

install(DIRECTORY engine/abi/bramah engine/sdk/bramah DESTINATION include FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp")
install(DIRECTORY scenes DESTINATION share/bramah FILES_MATCHING PATTERN "*.json")
install(FILES LICENSE DESTINATION share/doc/bramah)

configure_package_config_file(cmake/BramahConfig.cmake.in BramahConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(BramahConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES
  ${CMAKE_CURRENT_BINARY_DIR}/BramahConfig.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/BramahConfigVersion.cmake
  cmake/BramahPlugin.cmake
  cmake/BramahStamp.cmake
  cmake/plugin.map
  DESTINATION ${package_dir})
