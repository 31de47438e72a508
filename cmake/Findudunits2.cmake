# UDUNITS-2, which brings no CMake package of its own: target udunits2::udunits2.
find_path(udunits2_INCLUDE_DIR udunits2.h PATH_SUFFIXES udunits2)
find_library(udunits2_LIBRARY udunits2)
mark_as_advanced(udunits2_INCLUDE_DIR udunits2_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(udunits2 REQUIRED_VARS udunits2_LIBRARY udunits2_INCLUDE_DIR)

if(udunits2_FOUND AND NOT TARGET udunits2::udunits2)
  add_library(udunits2::udunits2 UNKNOWN IMPORTED)
  set_target_properties(udunits2::udunits2 PROPERTIES
    IMPORTED_LOCATION ${udunits2_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${udunits2_INCLUDE_DIR})
endif()
