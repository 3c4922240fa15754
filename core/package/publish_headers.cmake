# Copies the public headers to PELT_HEADER_DIR/pelt, where they name each other "pelt/core/chunk.hpp"
# in place of "core/chunk.hpp". A project that uses Pelt may then have a core/chunk.hpp of its own,
# first on its include path, and neither takes the other's.
#
# In: PELT_SOURCE_DIR, PELT_HEADER_DIR, PELT_PRIVATE_HEADERS (a regex). Out: PELT_PUBLISHED_HEADERS.
set(rooms core traces jobs platform_sim)
string(JOIN "|" any_room ${rooms})
set(PELT_PUBLISHED_HEADERS "")
foreach(room ${rooms})
  file(GLOB_RECURSE headers RELATIVE ${PELT_SOURCE_DIR} ${PELT_SOURCE_DIR}/${room}/*.hpp ${PELT_SOURCE_DIR}/${room}/*.h)
  list(FILTER headers EXCLUDE REGEX "${PELT_PRIVATE_HEADERS}")
  foreach(header ${headers})
    file(READ ${PELT_SOURCE_DIR}/${header} text)
    string(REGEX REPLACE "#include \"(${any_room})/" "#include \"pelt/\\1/" text "${text}")
    file(CONFIGURE OUTPUT ${PELT_HEADER_DIR}/pelt/${header} CONTENT "${text}" @ONLY)
    list(APPEND PELT_PUBLISHED_HEADERS ${PELT_SOURCE_DIR}/${header})
  endforeach()
endforeach()
