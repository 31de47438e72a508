# `cmake --install`: bin/zwidth, the rooms' libraries and headers, share/zwidth and the package that
# find_package(zwidth) finds. Rooms install themselves (zwidth_room.cmake), and
# so does the command.
include(CMakePackageConfigHelpers)

set(ZWIDTH_PACKAGE_INSTALL_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/zwidth)
set(ZWIDTH_DATA_INSTALL_DIR ${CMAKE_INSTALL_DATADIR}/zwidth)

install(DIRECTORY ${ZWIDTH_DATA_FOLDERS} DESTINATION ${ZWIDTH_DATA_INSTALL_DIR})

install(EXPORT zwidth NAMESPACE zwidth:: FILE zwidthTargets.cmake DESTINATION ${ZWIDTH_PACKAGE_INSTALL_DIR})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/zwidthConfig.cmake.in
  ${PROJECT_BINARY_DIR}/zwidthConfig.cmake
  INSTALL_DESTINATION ${ZWIDTH_PACKAGE_INSTALL_DIR} PATH_VARS ZWIDTH_DATA_INSTALL_DIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/zwidthConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/zwidthConfig.cmake
  ${PROJECT_BINARY_DIR}/zwidthConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/cmake/Findudunits2.cmake
  DESTINATION ${ZWIDTH_PACKAGE_INSTALL_DIR})
