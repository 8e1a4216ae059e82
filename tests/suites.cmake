# ctest reads this file to find the suites of a GoogleTest program. palpate_suites in CMakeLists.txt sets program, labels, cost
# and alone.
get_filename_component(name ${program} NAME)
if(NOT EXISTS ${program})
  add_test(${name}_IS_NOT_BUILT ${program})
  return()
endif()
execute_process(COMMAND ${program} --gtest_list_tests OUTPUT_VARIABLE listing RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "${program} --gtest_list_tests: ${failed}")
endif()
string(REGEX MATCHALL "\n[A-Za-z0-9_/]+\\." suites "\n${listing}")
# A suite without a case that ran counts as skipped; for a failed suite more text follows the list.
set(skipped "\\[  PASSED  \\] 0 tests\\.\n\\[  SKIPPED \\] [0-9]+ tests?, listed below:\n(\\[  SKIPPED \\] [^\n]*\n)+$")
foreach(line ${suites})
  string(REGEX REPLACE "\n(.*)\\." "\\1" suite "${line}")
  add_test(${suite} ${program} --gtest_filter=${suite}.*)
  set_tests_properties(${suite} PROPERTIES LABELS "${labels}" COST ${cost} RUN_SERIAL ${alone}
    SKIP_REGULAR_EXPRESSION "${skipped}")
endforeach()
