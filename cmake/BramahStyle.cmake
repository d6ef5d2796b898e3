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
  set(tidy_dir ${CMAKE_BINARY_DIR}/tidy)  # the compile commands without what only GCC knows
  add_custom_target(tidy
    COMMAND ${CMAKE_COMMAND} -E make_directory ${tidy_dir}
    COMMAND sed -n -e "s/ -fno-gnu-unique//" -e "w ${tidy_dir}/compile_commands.json" ${CMAKE_BINARY_DIR}/compile_commands.json
    COMMAND ${RUN_CLANG_TIDY} -quiet -clang-tidy-binary ${CLANG_TIDY} -p ${tidy_dir}
            "^${CMAKE_SOURCE_DIR}/(${folders})/.*[.]cpp$"
    VERBATIM)
endif()
