# cmake -DOUT=FILE -DFLAGS=... -DSOURCES=A;B;... -P BramahStamp.cmake
#
# Writes the stamp that both files of a plugin carry: a hash of their sources, of the headers beside these, and of the flags.
# No time and no path goes into it, so that builds stay reproducible.
set(all "${FLAGS}")
set(files ${SOURCES})
foreach(source IN LISTS SOURCES)
  cmake_path(GET source PARENT_PATH folder)
  file(GLOB headers ${folder}/*.h ${folder}/*.hpp)
  list(APPEND files ${headers})
endforeach()
list(REMOVE_DUPLICATES files)
foreach(one IN LISTS files)
  file(SHA256 ${one} hash)
  string(APPEND all " ${hash}")
endforeach()
string(SHA256 stamp "${all}")
file(CONFIGURE OUTPUT ${OUT} @ONLY CONTENT [[
/* Read from the file before it is loaded: NAME.so and NAME.v3.so of one build carry the same. */
__attribute__((used, section(".bramah_stamp"))) static const char bramah_stamp[] = "@stamp@";
]])
