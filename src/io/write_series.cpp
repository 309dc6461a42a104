#include "core/text.hpp"
#include "hyperiso/io.hpp"
#include "io/atomic_file.hpp"
#include "io/encoding.hpp"

#include <new>

namespace hyperiso {

Status write_series(const std::vector<SeriesEntry>& entries, const std::filesystem::path& path,
                    FileGroup* group) {
  try {
    auto file = AtomicFile::create(path);
    if (!file) return file.error();
    file->write("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
                "byte_order=\"LittleEndian\">\n<Collection>\n");
    for (const SeriesEntry& entry : entries)
      file->write(text("<DataSet timestep=\"", entry.time, "\" part=\"0\" file=\"",
                       xml_escaped(entry.file.generic_string()), "\"/>\n"));
    file->write("</Collection>\n</VTKFile>\n");
    return file->commit(group);
  } catch (const std::bad_alloc&) {
    return no_memory_to_write(path);
  }
}

} // namespace hyperiso
