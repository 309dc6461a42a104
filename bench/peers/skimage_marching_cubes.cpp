#include "peers.hpp"

#include "core/text.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace hyperiso::bench {

std::optional<double> skimage_marching_cubes_seconds(const Volume& volume, double isovalue) {
  const auto path = std::filesystem::temp_directory_path() / text("hyperiso-bench-", ::getpid(), ".raw");
  const auto [nx, ny, nz] = volume.dims;
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(volume.samples),
             std::streamsize{nx} * ny * nz * std::streamsize{sizeof(float)});
  const std::string command =
      text("/usr/bin/python3 " HYPERISO_BENCH_SOURCES "/peers/skimage_marching_cubes.py ", path.string(), " ",
           nx, " ", ny, " ", nz, " ", isovalue, " 2>/dev/null");
  double seconds = 0;
  FILE* output = ::popen(command.c_str(), "r");
  const bool read = output && std::fscanf(output, "%lf", &seconds) == 1;
  if (output) ::pclose(output);
  std::filesystem::remove(path);
  return read ? std::optional(seconds) : std::nullopt;
}

} // namespace hyperiso::bench
