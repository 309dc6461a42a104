// The kernels with what every processor of the target has (on x86-64: SSE2).
#define HYPERISO_INSTRUCTIONS baseline
#include "extract/kernels/instantiate.hpp"
