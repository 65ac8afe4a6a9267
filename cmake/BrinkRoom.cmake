# brink_room(NAME LIBRARY...): declares the target brink_NAME (alias brink::NAME) of one room, public on the rooms and
# libraries it stands on. Its sources are added by the folders of the room with target_sources().
function(brink_room name)
  add_library(brink_${name} STATIC)
  add_library(brink::${name} ALIAS brink_${name})
  set_target_properties(brink_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(brink_${name} PUBLIC cxx_std_20)
  target_include_directories(brink_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(brink_${name} PUBLIC ${ARGN})
  brink_flags(brink_${name})
  set_property(GLOBAL APPEND PROPERTY BRINK_ROOMS brink_${name})
endfunction()

# The flags of every target: warnings, and floating point that means the same bits everywhere.
function(brink_flags target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wnon-virtual-dtor -ffp-contract=off
    -fno-math-errno -fno-trapping-math  # change no bit of a result
    $<$<AND:$<BOOL:${BRINK_UNITY}>,$<CXX_COMPILER_ID:GNU>>:-Wno-subobject-linkage>  # each source is still one of its own
    $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1000000>  # free no memory below 1 GB: a tenth faster
    $<$<BOOL:${BRINK_WERROR}>:-Werror>)
  if(BRINK_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=address,undefined -fno-sanitize-recover=undefined
      -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=address,undefined)
  endif()
endfunction()

# Of targets in which no run spends its time: LEVEL of optimisation (-O2 compiles a fifth faster than -O3, -O1 some 30 % faster
# than that). Results have the same bits.
function(brink_not_hot target level)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:${level}>)
endfunction()

# What nearly every source includes, compiled once for a family of targets: the headers of foreign libraries are most of
# what a source costs. brink_precompile(TARGET HEADER...) gives TARGET headers of its own beside those of every source;
# brink_precompiled_as(TARGET OWNER) lets TARGET use OWNER's. Both must be of one kind, library or program.
set(BRINK_HEADERS <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory>
  <numbers> <numeric> <optional> <set> <span> <sstream> <string> <string_view> <tuple> <unordered_map> <utility> <variant>
  <vector> <Eigen/Core> <fmt/format.h>)
function(brink_precompile target)
  if(BRINK_PRECOMPILE)
    target_precompile_headers(${target} PRIVATE ${BRINK_HEADERS} ${ARGN})
  endif()
endfunction()
function(brink_precompiled_as target owner)
  if(BRINK_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM ${owner})
  endif()
endfunction()
