# What tests compute themselves is little; -O1 compiles them a fifth faster than a release's -O3.
add_library(zwidth_test_options INTERFACE)
target_compile_options(zwidth_test_options INTERFACE $<$<CONFIG:Release>:-O1>)
target_link_libraries(zwidth_test_options INTERFACE zwidth_warnings)

# zwidth_test(NAME SOURCES ... LIBRARIES ...): the test program NAME_test, one per room, run as one ctest entry.
function(zwidth_test name)
  cmake_parse_arguments(PARSE_ARGV 1 test "" "" "SOURCES;LIBRARIES")
  add_executable(${name}_test ${test_SOURCES})
  target_link_libraries(${name}_test PRIVATE ${test_LIBRARIES} GTest::gtest_main zwidth_test_options)
  target_include_directories(${name}_test PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  add_test(NAME ${name} COMMAND ${name}_test)
endfunction()
