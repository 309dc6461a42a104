#include "core/memory.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <sys/resource.h>

namespace hyperiso {
namespace {

namespace fs = std::filesystem;

// The first number in a file; nothing if there is none ("max" in a control group without a limit).
std::optional<std::uint64_t> number_in(const fs::path& path) {
  std::ifstream file(path);
  std::uint64_t number = 0;
  if (!(file >> number)) return std::nullopt;
  return number;
}

// The number behind `key` in a file of lines "key number" or "key: number".
std::optional<std::uint64_t> number_after(const fs::path& path, const std::string& key) {
  std::ifstream file(path);
  std::string word;
  while (file >> word) {
    std::uint64_t number = 0;
    if (word == key && file >> number) return number;
    std::getline(file, word);
  }
  return std::nullopt;
}

// What one control group leaves: its limit less its use, not counting cached file pages, which it gives back.
std::uint64_t left_in_group(const fs::path& group, const char* limit_file, const char* use_file,
                            const char* cache_key) {
  const auto limit = number_in(group / limit_file);
  const auto use = number_in(group / use_file);
  if (!limit || !use) return UINT64_MAX;
  const std::uint64_t cache = number_after(group / "memory.stat", cache_key).value_or(0);
  const std::uint64_t held = *use - std::min(*use, cache);
  return *limit - std::min(*limit, held);
}

// The least that the group of this process and those around it leave. Lines of /proc/self/cgroup:
// "0::/path" (version 2), "4:memory:/path" (version 1).
std::uint64_t left_in_groups() {
  std::uint64_t least = UINT64_MAX;
  std::ifstream file("/proc/self/cgroup");
  for (std::string line; std::getline(file, line);) {
    const auto first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const bool version_2 = controllers.empty();
    if (!version_2 && controllers != "memory") continue;
    const fs::path root = version_2 ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory";
    fs::path inside = fs::path(line.substr(second + 1)).relative_path();
    for (;; inside = inside.parent_path()) {
      const fs::path group = root / inside;
      least =
          std::min(least, version_2 ? left_in_group(group, "memory.max", "memory.current", "inactive_file")
                                    : left_in_group(group, "memory.limit_in_bytes", "memory.usage_in_bytes",
                                                    "total_inactive_file"));
      if (inside.empty()) break;
    }
  }
  return least;
}

} // namespace

std::uint64_t available_memory() {
  std::uint64_t available = left_in_groups();
  if (const auto kibibytes = number_after("/proc/meminfo", "MemAvailable:"))
    available = std::min(available, *kibibytes * 1024);
  return available;
}

std::uint64_t held_memory() { return number_after("/proc/self/status", "RssAnon:").value_or(0) * 1024; }

std::uint64_t peak_memory() {
  struct rusage usage {};
  if (::getrusage(RUSAGE_SELF, &usage) != 0) return 0;
#ifdef __APPLE__
  return static_cast<std::uint64_t>(usage.ru_maxrss);
#else
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
#endif
}

} // namespace hyperiso
