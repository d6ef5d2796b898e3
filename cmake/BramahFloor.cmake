# bramah_floor(<folder> [SEES <folders>...] [OFFERS <libraries>...] [USES <libraries>...])
#
# The library bramah::<folder>, made of every *.cpp in the calling directory.
#   SEES    the lower floors whose headers it may include (tests/layers reads the includes and holds it to that)
#   OFFERS  outside libraries whose types appear in its headers
#   USES    outside libraries that its sources alone know
# A folder without sources is an INTERFACE library, so that headers may come first.
function(bramah_floor folder)
  cmake_parse_arguments(PARSE_ARGV 1 floor "" "" "SEES;OFFERS;USES")
  list(TRANSFORM floor_SEES PREPEND bramah::)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  set(target bramah_${folder})
  if(sources)
    add_library(${target} STATIC ${sources})
    target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR}/engine)
    target_link_libraries(${target} PUBLIC ${floor_SEES} ${floor_OFFERS} PRIVATE ${floor_USES} bramah_warnings)
  else()
    add_library(${target} INTERFACE)
    target_include_directories(${target} INTERFACE ${PROJECT_SOURCE_DIR}/engine)
    target_link_libraries(${target} INTERFACE ${floor_SEES} ${floor_OFFERS})
  endif()
  add_library(bramah::${folder} ALIAS ${target})
endfunction()
