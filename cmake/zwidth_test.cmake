# zwidth_test(NAME SOURCES ... LIBRARIES ...): the test program NAME_test, one per room, run as one ctest entry.
function(zwidth_test name)
  cmake_parse_arguments(PARSE_ARGV 1 test "" "" "SOURCES;LIBRARIES")
  add_executable(${name}_test ${test_SOURCES})
  target_link_libraries(${name}_test PRIVATE ${test_LIBRARIES} GTest::gtest_main zwidth_warnings)
  target_include_directories(${name}_test PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_compile_definitions(${name}_test PRIVATE ZWIDTH_TEST_DATA="${PROJECT_SOURCE_DIR}/tests/data")
  add_test(NAME ${name} COMMAND ${name}_test)
endfunction()
