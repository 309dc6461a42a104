#pragma once
// The most memory that this process held, as the system tells it.

#include <cstdint>
#include <fstream>
#include <malloc.h>
#include <optional>
#include <string>

namespace hyperiso::check {

// A figure of /proc/self/status, in bytes; 0 if there is none.
inline std::uint64_t memory_figure(const std::string& key) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(key)) return std::stoull(line.substr(key.size() + 1)) * 1024;
  return 0;
}

// From here on the peak counts anew.
inline bool forget_peak() {
  std::ofstream file("/proc/self/clear_refs");
  return static_cast<bool>(file << "5" << std::flush);
}

// What `work` held at most beside what there was before; nothing if the system does not tell, or a sanitizer
// holds much more.
template <class Work>
std::optional<std::uint64_t> peak_memory_of([[maybe_unused]] Work&& work) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return std::nullopt;
#else
  malloc_trim(0); // what others left in the heap would hide what `work` takes of it
  if (memory_figure("VmHWM:") == 0 || !forget_peak()) return std::nullopt;
  const std::uint64_t before = memory_figure("VmRSS:");
  work();
  return memory_figure("VmHWM:") - before;
#endif
}

} // namespace hyperiso::check
