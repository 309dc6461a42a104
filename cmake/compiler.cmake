# The compiler settings shared by everything built here; none of them reach users of the library.
add_library(hyperiso_compiler INTERFACE)
target_compile_options(hyperiso_compiler INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow
  # A fused multiply-add rounds differently: the same input must give the same bytes on every path.
  -ffp-contract=off)

# On for the compiler that every change is checked with. Another may warn of things nobody has seen yet, and
# that must not stop a user's build.
set(werror OFF)
if(PROJECT_IS_TOP_LEVEL AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION MATCHES "^12\\.")
  set(werror ON)
endif()
option(HYPERISO_WERROR "Treat warnings as errors" ${werror})
if(HYPERISO_WERROR)
  target_compile_options(hyperiso_compiler INTERFACE -Werror)
endif()

set(HYPERISO_SANITIZE "" CACHE STRING "Sanitizers to build with, for example address,undefined")
if(HYPERISO_SANITIZE)
  add_compile_options(-fsanitize=${HYPERISO_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${HYPERISO_SANITIZE})
endif()

if(PROJECT_IS_TOP_LEVEL)
  find_program(CCACHE ccache)
  if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
  endif()
endif()
