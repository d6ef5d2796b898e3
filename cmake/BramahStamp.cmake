# cmake -DOUT=FILE -DFLAGS=... -DFILES=A;B;... -P BramahStamp.cmake
#
# Writes the stamp that both files of a plugin carry: a hash of the files, and of the flags.
# No time and no path goes into it, so that builds stay reproducible.
set(all "${FLAGS}")
foreach(one IN LISTS FILES)
  file(SHA256 ${one} hash)
  string(APPEND all " ${hash}")
endforeach()
string(SHA256 stamp "${all}")
file(CONFIGURE OUTPUT ${OUT} @ONLY CONTENT [[
/* Read from the file before it is loaded: NAME.so and NAME.v3.so of one build carry the same. */
__attribute__((used, section(".bramah_stamp"))) static const char bramah_stamp[] = "@stamp@";
]])
