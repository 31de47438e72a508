# zwidth_room(NAME SOURCES ... ROOMS ... PUBLIC ... PRIVATE ...): the static library zwidth::NAME from src/NAME.
# ROOMS are the rooms it may include, PUBLIC and PRIVATE the outside libraries it links. The same lists are what
# the include rule test holds the sources to.
function(zwidth_room name)
  cmake_parse_arguments(PARSE_ARGV 1 room "" "" "SOURCES;ROOMS;PUBLIC;PRIVATE")
  add_library(zwidth_${name} STATIC ${room_SOURCES})
  add_library(zwidth::${name} ALIAS zwidth_${name})
  set_target_properties(zwidth_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(zwidth_${name} PUBLIC cxx_std_20)
  target_include_directories(zwidth_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  set(rooms ${room_ROOMS})
  list(TRANSFORM rooms PREPEND zwidth::)
  target_link_libraries(zwidth_${name}
    PUBLIC ${rooms} ${room_PUBLIC} PRIVATE ${room_PRIVATE} $<BUILD_INTERFACE:zwidth_warnings>)

  install(TARGETS zwidth_${name} EXPORT zwidth ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/zwidth/${name}
    FILES_MATCHING PATTERN "*.h" PATTERN internal EXCLUDE)

  string(JOIN " " may_include ${room_ROOMS})
  string(JOIN " " may_use ${room_PUBLIC} ${room_PRIVATE})
  set_property(GLOBAL APPEND_STRING PROPERTY ZWIDTH_ROOMS "${name} | ${may_include} | ${may_use}\n")
endfunction()

# Headers are included as "zwidth/ROOM/NAME.h" in the build tree as when installed.
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/include)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/src ${PROJECT_BINARY_DIR}/include/zwidth SYMBOLIC)

add_library(zwidth_warnings INTERFACE)
target_compile_options(zwidth_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wno-missing-field-initializers $<$<BOOL:${ZWIDTH_WARNINGS_AS_ERRORS}>:-Werror>)
