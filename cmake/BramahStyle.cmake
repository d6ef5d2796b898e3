# Targets that are not built by default, where the programs are found: `format` rewrites the sources, `format-check` fails on
# a source that `format` would change, `tidy` runs the checks of .clang-tidy.
set(style_folders engine components plugins bench tests)
find_program(CLANG_FORMAT NAMES clang-format-14 clang-format)
find_program(CLANG_TIDY NAMES clang-tidy-14 clang-tidy)
find_program(RUN_CLANG_TIDY NAMES run-clang-tidy-14 run-clang-tidy)
mark_as_advanced(CLANG_FORMAT CLANG_TIDY RUN_CLANG_TIDY)

if(CLANG_FORMAT)
  set(globs)
  foreach(folder ${style_folders})
    foreach(ending cpp hpp c h)
      list(APPEND globs "${CMAKE_SOURCE_DIR}/${folder}/*.${ending}")
    endforeach()
  endforeach()
  file(GLOB_RECURSE style_sources CONFIGURE_DEPENDS ${globs})
  add_custom_target(format COMMAND ${CLANG_FORMAT} -i ${style_sources} VERBATIM)
  add_custom_target(format-check COMMAND ${CLANG_FORMAT} --dry-run -Werror ${style_sources} VERBATIM)
endif()

if(CLANG_TIDY AND RUN_CLANG_TIDY)
  list(JOIN style_folders "|" folders)
  add_custom_target(tidy COMMAND ${RUN_CLANG_TIDY} -quiet -clang-tidy-binary ${CLANG_TIDY} -p ${CMAKE_BINARY_DIR}
                                 "^${CMAKE_SOURCE_DIR}/(${folders})/.*[.]cpp$" VERBATIM)
endif()
