# bramah_add_plugin(<name> [NO_INSTALL] <sources>...)
#
# A library of components that Bramah loads at run time: <name>.so, and with BRAMAH_V3_TWINS on x86-64 also <name>.v3.so,
# the same sources compiled for processors with AVX2 and FMA. The targets are <name> and <name>.v3.
# Put where BRAMAH_PLUGIN_OUTPUT_DIRECTORY says, if it is set; installed to lib/bramah/plugins, unless NO_INSTALL.
# Optimized unless a build type says otherwise: a plugin's inner loops are the engine's.
# One file serves Bramah itself and, from the installed package, everybody else.
if(CMAKE_BUILD_TYPE STREQUAL "Release" OR NOT CMAKE_BUILD_TYPE)
  option(BRAMAH_V3_TWINS "Compile each plugin a second time for x86-64-v3 (AVX2, FMA)" ON)
else()
  option(BRAMAH_V3_TWINS "Compile each plugin a second time for x86-64-v3 (AVX2, FMA)" OFF)
endif()

set(BRAMAH_PLUGIN_MAP ${CMAKE_CURRENT_LIST_DIR}/plugin.map)
set(BRAMAH_PLUGIN_STAMP ${CMAKE_CURRENT_LIST_DIR}/BramahStamp.cmake)

function(bramah_add_plugin name)
  # A whole second file rather than a second translation unit: the linker might give a template instantiated for AVX2 to
  # the code meant for every processor.
  bramah_add_plugin_variant(${name} ${ARGN})
  if(BRAMAH_V3_TWINS AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
    bramah_add_plugin_variant(${name}.v3 ${ARGN})
    target_compile_options(${name}.v3 PRIVATE -march=x86-64-v3)
    # Whoever builds one gets both.
    bramah_stamp_plugin(${name} ${name}.v3)
    add_dependencies(${name} ${name}.v3)
  endif()
endfunction()

# The engine refuses twins whose stamps differ: one of them is old.
function(bramah_stamp_plugin name twin)
  get_target_property(sources ${name} SOURCES)
  set(files "")
  set(headers "")
  foreach(source IN LISTS sources)
    cmake_path(ABSOLUTE_PATH source NORMALIZE)
    cmake_path(GET source PARENT_PATH folder)
    file(GLOB beside CONFIGURE_DEPENDS ${folder}/*.h ${folder}/*.hpp)
    list(APPEND files ${source})
    list(APPEND headers ${beside})
  endforeach()
  list(APPEND files ${headers})
  list(REMOVE_DUPLICATES files)
  get_property(languages GLOBAL PROPERTY ENABLED_LANGUAGES)
  set(language C)
  set(ending c)
  if(CXX IN_LIST languages)
    set(language CXX)
    set(ending cpp)
  endif()
  string(TOUPPER "${CMAKE_BUILD_TYPE}" config)
  set(flags "${CMAKE_${language}_COMPILER_ID} ${CMAKE_${language}_COMPILER_VERSION} ${CMAKE_${language}_FLAGS}")
  string(APPEND flags " ${CMAKE_${language}_FLAGS_${config}}")
  set(stamp ${CMAKE_CURRENT_BINARY_DIR}/${name}_stamp.${ending})
  add_custom_command(OUTPUT ${stamp}
    COMMAND ${CMAKE_COMMAND} -DOUT=${stamp} "-DFLAGS=${flags}" "-DFILES=${files}" -P ${BRAMAH_PLUGIN_STAMP}
    DEPENDS ${files} ${BRAMAH_PLUGIN_STAMP}
    COMMENT "Stamping ${name}" VERBATIM)
  add_custom_target(${name}.stamp DEPENDS ${stamp})
  foreach(target ${name} ${twin})
    target_sources(${target} PRIVATE ${stamp})
    add_dependencies(${target} ${name}.stamp)
  endforeach()
endfunction()

function(bramah_add_plugin_variant target)
  cmake_parse_arguments(PARSE_ARGV 1 plugin "NO_INSTALL" "" "")
  # A plugin in plain C needs the C header only, and no C++ compiler.
  get_property(languages GLOBAL PROPERTY ENABLED_LANGUAGES)
  if(CXX IN_LIST languages)
    set(border Bramah::sdk)
  else()
    set(border Bramah::abi)
  endif()
  add_library(${target} MODULE ${plugin_UNPARSED_ARGUMENTS})
  target_link_libraries(${target} PRIVATE ${border})
  set_target_properties(${target} PROPERTIES
    PREFIX ""
    SUFFIX ".so"
    POSITION_INDEPENDENT_CODE ON
    C_VISIBILITY_PRESET hidden
    CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON
    CXX_EXTENSIONS OFF
    LINK_DEPENDS ${BRAMAH_PLUGIN_MAP})
  if(BRAMAH_PLUGIN_OUTPUT_DIRECTORY)
    set_target_properties(${target} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${BRAMAH_PLUGIN_OUTPUT_DIRECTORY})
  endif()
  # Hidden visibility alone still exports instantiations of standard templates, some of them unique in the whole process:
  # the version script leaves the one entry point.
  target_compile_options(${target} PRIVATE
    $<$<OR:$<CONFIG:Release>,$<CONFIG:>>:-O3>
    $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fno-gnu-unique>)
  target_link_options(${target} PRIVATE LINKER:--version-script=${BRAMAH_PLUGIN_MAP} LINKER:--exclude-libs,ALL)
  if(NOT plugin_NO_INSTALL)
    install(TARGETS ${target} LIBRARY DESTINATION lib/bramah/plugins)
  endif()
endfunction()
