# Target `lint`: clang-format over every source, clang-tidy over the library and the command. A file is read again
# only when it or a header changed.
find_program(ZWIDTH_CLANG_FORMAT clang-format)
find_program(ZWIDTH_CLANG_TIDY clang-tidy)
if(NOT ZWIDTH_CLANG_FORMAT OR NOT ZWIDTH_CLANG_TIDY)
  return()
endif()

file(GLOB_RECURSE tidied CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/src/*.cpp ${PROJECT_SOURCE_DIR}/apps/*.cpp)
file(GLOB_RECURSE headers CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/src/*.h ${PROJECT_SOURCE_DIR}/apps/*.h)
file(GLOB_RECURSE others CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/tests/*.cpp ${PROJECT_SOURCE_DIR}/tests/*.h
  ${PROJECT_SOURCE_DIR}/bench/*.cpp ${PROJECT_SOURCE_DIR}/bench/*.h
  ${PROJECT_SOURCE_DIR}/examples/*.cpp)

set(stamps ${PROJECT_BINARY_DIR}/lint)
add_custom_command(OUTPUT ${stamps}/format.stamp
  COMMAND ${ZWIDTH_CLANG_FORMAT} --dry-run -Werror ${tidied} ${headers} ${others}
  COMMAND ${CMAKE_COMMAND} -E touch ${stamps}/format.stamp
  DEPENDS ${tidied} ${headers} ${others} ${PROJECT_SOURCE_DIR}/.clang-format
  COMMENT "clang-format" VERBATIM)
set(lint_stamps ${stamps}/format.stamp)

foreach(source ${tidied})
  file(RELATIVE_PATH name ${PROJECT_SOURCE_DIR} ${source})
  string(REPLACE "/" "." stamp ${name})
  set(stamp ${stamps}/${stamp}.stamp)
  add_custom_command(OUTPUT ${stamp}
    COMMAND ${PROJECT_SOURCE_DIR}/tools/tidy ${PROJECT_BINARY_DIR} ${source} ${stamp}
    DEPENDS ${source} ${headers} ${PROJECT_SOURCE_DIR}/.clang-tidy
    COMMENT "clang-tidy ${name}" VERBATIM)
  list(APPEND lint_stamps ${stamp})
endforeach()

add_custom_target(lint DEPENDS ${lint_stamps})
