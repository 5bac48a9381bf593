# Installs BUILD, takes the C++ out of SOURCE/README.md, builds it against the installed tandem and
# runs it from SOURCE.
cmake_minimum_required(VERSION 3.24)
set(folder ${BUILD}/consumer)
file(REMOVE_RECURSE ${folder})

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE failed OUTPUT_VARIABLE output
                  ERROR_VARIABLE output WORKING_DIRECTORY ${SOURCE})
  if(failed)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command} ended with ${failed}:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(READ ${SOURCE}/README.md readme)
file(READ ${SOURCE}/examples/01_plan_two_arms.cpp example)
string(FIND "${readme}" "```cpp\n${example}```" found)
if(found EQUAL -1)
  message(FATAL_ERROR "README.md must show examples/01_plan_two_arms.cpp as it is; copy it there")
endif()
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${folder}/prefix)
file(COPY ${SOURCE}/tests/consumer/project/CMakeLists.txt DESTINATION ${folder}/project)
file(WRITE ${folder}/project/main.cpp "${example}")
run(${CMAKE_COMMAND} -S ${folder}/project -B ${folder}/build -G Ninja
    -DCMAKE_PREFIX_PATH=${folder}/prefix -DCMAKE_BUILD_TYPE=${TYPE}
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS})
run(${CMAKE_COMMAND} --build ${folder}/build)
run(${folder}/build/consumer)
if(NOT output MATCHES "^0 s: ")
  message(FATAL_ERROR "the program ran, but printed no motion:\n${output}")
endif()
