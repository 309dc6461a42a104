# The compiler settings shared by everything built here; none of them reach users of the library.
add_library(hyperiso_compiler INTERFACE)
target_compile_options(hyperiso_compiler INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow
  # A fused multiply-add rounds differently: the same input must give the same bytes on every path.
  -ffp-contract=off)

option(HYPERISO_WERROR "Treat warnings as errors" OFF)
if(HYPERISO_WERROR)
  target_compile_options(hyperiso_compiler INTERFACE -Werror)
endif()

set(HYPERISO_SANITIZE "" CACHE STRING "Sanitizers to build with, for example address,undefined")
if(HYPERISO_SANITIZE)
  add_compile_options(-fsanitize=${HYPERISO_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${HYPERISO_SANITIZE})
endif()

find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()
