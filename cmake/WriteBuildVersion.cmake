# Writes build_version.h anew only where the version or the commit changed, so that an unchanged tree
# rebuilds nothing. Run at every build: -DSOURCE= -DOUTPUT= -DVERSION=
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT commit)
  set(commit "unknown")
endif()
set(text "#pragma once\n#define SANDWRIGHT_VERSION \"${VERSION}\"\n#define SANDWRIGHT_COMMIT \"${commit}\"\n")
set(old "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} old)
endif()
if(NOT old STREQUAL text)
  file(WRITE ${OUTPUT} "${text}")
endif()
