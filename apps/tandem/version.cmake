# cmake -DVERSION=x.y.z -DSOURCE=folder -DHEADER=file -P version.cmake: writes version.h if it changed.
set(commit "")
find_program(GIT git)
if(GIT AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${GIT} -C ${SOURCE} describe --always --dirty --exclude=*
                  OUTPUT_VARIABLE commit RESULT_VARIABLE failed ERROR_QUIET
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(failed)
    set(commit "")
  endif()
endif()
set(text "tandem ${VERSION}")
if(commit)
  string(APPEND text " (${commit})")
endif()
file(CONFIGURE OUTPUT ${HEADER} CONTENT "#pragma once\nconstexpr const char* kVersionText = \"${text}\";\n")
