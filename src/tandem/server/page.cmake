# cmake -DPAGE=file -DCOPY=file -P page.cmake: copies the page if it changed; without one, an empty file.
if(EXISTS ${PAGE})
  file(COPY_FILE ${PAGE} ${COPY} ONLY_IF_DIFFERENT)
else()
  file(CONFIGURE OUTPUT ${COPY} CONTENT "")
endif()
