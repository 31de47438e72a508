# orocos_kdl::orocos_kdl, the kinematics library that the tests and benchmarks compare with. Debian's own package
# configuration defines variables and no target, so header and library are looked up here.
find_path(OROCOS_KDL_INCLUDE_DIR kdl/chain.hpp)
find_library(OROCOS_KDL_LIBRARY orocos-kdl)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(orocos_kdl REQUIRED_VARS OROCOS_KDL_LIBRARY OROCOS_KDL_INCLUDE_DIR)
if(orocos_kdl_FOUND AND NOT TARGET orocos_kdl::orocos_kdl)
  add_library(orocos_kdl::orocos_kdl UNKNOWN IMPORTED)
  set_target_properties(orocos_kdl::orocos_kdl PROPERTIES
    IMPORTED_LOCATION ${OROCOS_KDL_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${OROCOS_KDL_INCLUDE_DIR}
    INTERFACE_LINK_LIBRARIES Eigen3::Eigen)
endif()
