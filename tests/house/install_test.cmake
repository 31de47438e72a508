# Installs BUILD into a folder of its own under WORK, builds the examples (CONSUMER) against it with
# find_package(zwidth), and runs the first one and the installed command.
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGV}\nended with ${status}:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
file(GLOB_RECURSE internal ${WORK}/prefix/include/zwidth/*/internal/*)
if(internal)
  message(FATAL_ERROR "internal headers are installed: ${internal}")
endif()

run(${CMAKE_COMMAND} -S ${CONSUMER} -B ${WORK}/consumer -G Ninja -D CMAKE_BUILD_TYPE=Release
    -D CMAKE_PREFIX_PATH=${WORK}/prefix -D CMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})
run(${CMAKE_COMMAND} --build ${WORK}/consumer --target 01_read_a_device)
run(${CMAKE_COMMAND} -E env ZWIDTH_DATA=${WORK}/prefix/share/zwidth ${WORK}/consumer/01_read_a_device delta)
run(${WORK}/prefix/bin/zwidth devices)
if(NOT output MATCHES "delta")
  message(FATAL_ERROR "the installed zwidth does not find its devices:\n${output}")
endif()
