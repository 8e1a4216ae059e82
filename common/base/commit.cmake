# Writes the file SOURCE, which defines commit() of program.hpp, unless it has the commit of SOURCE_DIR already.
execute_process(COMMAND git -C ${SOURCE_DIR} describe --always --dirty=+changed --exclude=* OUTPUT_VARIABLE commit
  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit unknown)
endif()
file(CONFIGURE OUTPUT ${SOURCE} CONTENT
  "#include \"common/base/program.hpp\"\nconst char* palpate::commit() { return \"${commit}\"; }\n")
