# Copies the pages for engines to PELT_PAGES_DIR. A link leads to what is installed: another page, a shader, a public
# header; one to what is not becomes its text.
#
# In: PELT_SOURCE_DIR, PELT_PUBLISHED_HEADERS (publish_headers.cmake), PELT_PAGES_DIR, PELT_PAGES_TO_HEADERS.
cmake_policy(PUSH)
cmake_policy(VERSION 3.24)
foreach(page README.md DRAWING.md)
  file(READ ${PELT_SOURCE_DIR}/jobs/${page} text)
  string(REPLACE "](" "<to>(" text "${text}")  # a bracket alone would join the list below
  string(REGEX MATCHALL "<to>\\([^)#:]+\\)" links "${text}")
  list(REMOVE_DUPLICATES links)
  foreach(link ${links})
    string(REGEX REPLACE "^<to>\\((.*)\\)$" "\\1" target "${link}")
    cmake_path(ABSOLUTE_PATH target BASE_DIRECTORY ${PELT_SOURCE_DIR}/jobs NORMALIZE OUTPUT_VARIABLE file)
    if(file IN_LIST PELT_PUBLISHED_HEADERS)
      file(RELATIVE_PATH header ${PELT_SOURCE_DIR} ${file})
      string(REPLACE "${link}" "<to>(${PELT_PAGES_TO_HEADERS}/${header})" text "${text}")
    elseif(NOT target MATCHES "^(README\\.md|DRAWING\\.md|shaders/.*|\\.\\./bench/shading/shaders/.*)$")
      string(REGEX REPLACE "\\[([^][]*)<to>\\(${target}\\)" "\\1" text "${text}")
    endif()
  endforeach()
  string(REPLACE "<to>(" "](" text "${text}")
  file(WRITE ${PELT_PAGES_DIR}/${page} "${text}")
endforeach()
cmake_policy(POP)
