// NRRD: a text header with the samples behind it (.nrrd) or in other files (.nhdr).
// Format: teem.sourceforge.net/nrrd/format.html, versions 1 to 5.

#include "core/text.hpp"
#include "io/formats.hpp"
#include "io/nrrd_header.hpp"

#include <bit>

namespace hyperiso {
namespace {

Error malformed(const InputFile& file, std::string_view what) {
  return {Code::file_malformed, text(file.path().string(), ": ", what)};
}

Result<std::uint64_t> after_lines(const InputFile& file, std::uint64_t offset, std::int64_t lines) {
  for (std::int64_t line = 0; line < lines; ++line) {
    const std::size_t end = file.characters().find('\n', offset);
    if (end == std::string_view::npos)
      return malformed(file, text("\"line skip:\" is ", lines, ", but only ", line, " lines follow"));
    offset = end + 1;
  }
  return offset;
}

// Raw data may be followed by something else only where the header says that the file is not theirs alone.
Result<std::uint64_t> start_of_raw_data(const InputFile& file, std::uint64_t offset, std::int64_t byte_skip,
                                        std::uint64_t bytes) {
  const std::uint64_t available = file.size() - offset;
  const auto too_short = [&](std::uint64_t skipped) {
    return malformed(file,
                     text("the sizes need ", bytes, " bytes of samples",
                          skipped > 0 ? text(" beside ", skipped, " skipped") : "", ", but the file has ",
                          available, file.size() > available ? " after its header" : ""));
  };
  if (byte_skip < 0) { // -1: the data end the file; -1 - n: n bytes follow them
    const std::uint64_t after = ~static_cast<std::uint64_t>(byte_skip);
    if (after > available || available - after < bytes) return too_short(after);
    return file.size() - after - bytes;
  }
  const auto skip = static_cast<std::uint64_t>(byte_skip);
  if (skip > available || available - skip < bytes) return too_short(skip);
  if (skip == 0 && available != bytes)
    return malformed(file, text("the sizes need ", bytes, " bytes of samples, but ", available,
                                " are there; if the samples are a part of the file, say \"byte skip:\""));
  return offset + skip;
}

Result<std::unique_ptr<ByteSource>> open_data(std::shared_ptr<const InputFile> file, std::uint64_t offset,
                                              const NrrdData& data, SampleType type, std::uint64_t bytes) {
  const auto start = after_lines(*file, offset, data.line_skip);
  if (!start) return start.error();
  if (data.encoding == NrrdEncoding::raw) {
    const auto begin = start_of_raw_data(*file, *start, data.byte_skip, bytes);
    if (!begin) return begin.error();
    return plain_source(std::move(file), *begin);
  }
  const auto skip = static_cast<std::uint64_t>(data.byte_skip);
  const std::uint64_t available = file->size() - *start;

  if (data.encoding == NrrdEncoding::gzip || data.encoding == NrrdEncoding::bzip2) {
    const auto compression = data.encoding == NrrdEncoding::gzip ? Compression::gzip : Compression::bzip2;
    if (bytes / largest_expansion(compression) > available)
      return malformed(*file, text("the sizes need ", bytes, " bytes of samples, more than ", available,
                                   " compressed bytes can hold"));
    const std::uint64_t at = *start;
    return stream_source([file, at, compression] { return open_compressed(compression, file, at); }, skip,
                         bytes, skip > 0);
  }

  if (skip > available)
    return malformed(*file,
                     text("\"byte skip:\" is ", skip, ", but the file has only ", available, " bytes"));
  const std::uint64_t at = *start + skip;
  const bool is_text = data.encoding == NrrdEncoding::text;
  const std::uint64_t least_characters = is_text ? bytes / size_of(type) * 2 - 1 : bytes * 2;
  if (least_characters > file->size() - at)
    return malformed(*file, text("the sizes need at least ", least_characters, " characters, but ",
                                 file->size() - at, " are there"));
  return stream_source(
      [file, at, type, is_text]() -> Result<std::unique_ptr<Decoder>> {
        if (is_text) return text_decoder(file, file->characters().substr(at), type, file->path().string());
        return hex_decoder(file, at);
      },
      0, bytes);
}

// Opens each file once, so that a missing or short one is reported before any sample is read.
Result<std::unique_ptr<ByteSource>> open_data_files(const std::filesystem::path& header_path,
                                                    const NrrdData& data, SampleType type,
                                                    std::uint64_t bytes) {
  const std::uint64_t bytes_each = bytes / data.files;
  const auto open_file = [folder = header_path.parent_path(), data, type,
                          bytes_each](std::uint64_t i) -> Result<std::unique_ptr<ByteSource>> {
    auto file = InputFile::open(folder / data.file_name(i));
    if (!file) return file.error();
    return open_data(std::move(*file), 0, data, type, bytes_each);
  };
  if (data.files == 1) return open_file(0);
  for (std::uint64_t i = 0; i < data.files; ++i)
    if (const auto source = open_file(i); !source) return source.error();
  return joined_source(open_file, bytes_each);
}

} // namespace

OpenedField open_nrrd(const std::filesystem::path& path, const ReadOptions& options) {
  auto file = InputFile::open(path);
  if (!file) return file.error();
  const auto header = parse_nrrd_header((*file)->characters(), path);
  if (!header) return header.error();
  auto content = interpret_nrrd_header(*header, path);
  if (!content) return content.error();
  const NrrdData& data = content->data;
  const SampleType type = content->field.type;
  const auto bytes = bytes_of(content->field.axes, type, path);
  if (!bytes) return bytes.error();

  auto source = data.files == 0 ? open_data(std::move(*file), header->end, data, type, *bytes)
                                : open_data_files(path, data, type, *bytes);
  if (!source) return source.error();
  for (std::uint64_t i = 0; i < data.files; ++i)
    content->field.files.push_back(path.parent_path() / data.file_name(i));
  const bool swap = data.big_endian != (std::endian::native == std::endian::big);
  return read_stored(std::move(content->field), std::move(*source), swap, path, options);
}

} // namespace hyperiso
