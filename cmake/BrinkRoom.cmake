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
    $<$<BOOL:${BRINK_WERROR}>:-Werror>)
  if(BRINK_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=address,undefined -fno-sanitize-recover=undefined
      -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=address,undefined)
  endif()
endfunction()
