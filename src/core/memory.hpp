#pragma once
// What the machine can still give.

#include <cstdint>

namespace hyperiso {

// Bytes that this process can take without swapping, nor being killed for it: what Linux counts as available,
// less where a control group (a container, a batch job) allows less. UINT64_MAX where the system does not
// tell.
std::uint64_t available_memory();

// Bytes of its own that this process holds now, and the most that it ever held with what it maps; 0 where the
// system does not tell.
std::uint64_t held_memory();
std::uint64_t peak_memory();

} // namespace hyperiso
