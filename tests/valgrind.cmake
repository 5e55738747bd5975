# Tests under valgrind: the examples on a short budget, the tests of lib/base and of the C ABI's contract, and each algorithm.
# RDM_EXAMPLES and RDM_VALGRIND_TESTS are those of the CMakeLists.txt that includes this file; RDM_FILTER_NAME and RDM_PROGRAM_NAME say
# which suites of which program are test NAME.

find_program(RDM_VALGRIND valgrind REQUIRED)

function(rdm_valgrind_test name program)
  add_test(NAME valgrind_${name} COMMAND ${RDM_VALGRIND} -q --error-exitcode=99 --leak-check=full
           --errors-for-leak-kinds=definite $<TARGET_FILE:${program}> ${ARGN})
  set_tests_properties(valgrind_${name} PROPERTIES LABELS valgrind TIMEOUT 1800)
endfunction()

set(short_01_step 5)
set(short_02_many_worlds 5 2)
set(short_03_train 1 valgrind.rdm)
set(short_05_own_environment 1)
set(short_07_own_task 1)
set(short_10_own_eyes 3 2)
set(short_08_own_robot ${args_08_own_robot} ur5e 1)
set(short_11_teach ${PROJECT_SOURCE_DIR}/examples/policies/ant_run.rdm 2 3)
foreach(name ${RDM_EXAMPLES})
  rdm_valgrind_test(${name} ${name} ${short_${name}})
endforeach()

# What valgrind cannot see: it has no flush-to-zero and no rounding modes, no AVX-512 and no long double wider than double; it puts its
# own operator new over a test's; a forked child leaves the memory of threads that it has not. And runs that learn to the end would
# take hours.
list(REMOVE_ITEM RDM_VALGRIND_TESTS test_fpmode test_simd_avx512 test_workers_memory test_contract_limits)
set(without_test_workers *FloatingPointMode:*ForkedChildIsTold*)
set(without_test_elementary Accuracy.*)
set(without_test_contract_host *AForkedChildIsTold*)
foreach(name ${RDM_VALGRIND_TESTS})
  if(DEFINED RDM_FILTER_${name})
    rdm_valgrind_test(${name} ${RDM_PROGRAM_${name}} --gtest_filter=${RDM_FILTER_${name}}-${without_${name}})
  else()
    rdm_valgrind_test(${name} ${name})
  endif()
endforeach()

# Example 05 with each algorithm would take hours; these runs of the learner take minutes.
if(TARGET tests_algos)
  rdm_valgrind_test(each_algo tests_algos --gtest_filter=*EveryAlgo.Learns*)
endif()
