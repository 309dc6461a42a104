// VTK's XML image data (.vti), inline base64 with zlib; with time a series of them, named by a .pvd.

#include "core/text.hpp"
#include "io/encoding.hpp"
#include "io/formats.hpp"
#include "io/sample_runs.hpp"
#include "io/vtk_xml.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace hyperiso {
namespace {

VtkType vtk_type(SampleType type) {
  return visit_sample_type(type, [](auto sample) { return vtk_type_of<decltype(sample)>(); });
}

// The attributes of <ImageData>, and the samples in the order that goes with them.
struct Image {
  Field field;
  std::array<std::int64_t, 3> low{}, high{};
  std::array<double, 3> origin{}, spacing{1, 1, 1};
  std::array<double, 9> direction{1, 0, 0, 0, 1, 0, 0, 0, 1};
};

// Samples are at Origin + i * Spacing for i in the extent: with the numbers that a cropped axis keeps of the
// whole, each has the coordinate it has there, to the bit. Spacings must be positive, so an axis whose
// coordinates fall is written backwards.
void place_evenly(Image& image, std::size_t k) {
  const Axis& axis = image.field.info.axes[k];
  image.origin[k] = axis.origin;
  image.spacing[k] = std::abs(axis.spacing);
  image.low[k] = axis.first;
  image.high[k] = axis.first + axis.count - 1;
  if (axis.spacing > 0) return;
  std::swap(image.low[k], image.high[k]);
  image.low[k] *= -1;
  image.high[k] *= -1;
  const auto last =
      (axis.count - 1) * image.field.strides[k] * static_cast<std::int64_t>(size_of(image.field.info.type));
  image.field.samples =
      std::shared_ptr<const std::byte>(image.field.samples, image.field.samples.get() + last);
  image.field.strides[k] *= -1;
}

// The samples of the world: Origin + Direction * (i * Spacing).
void place_in_world(Image& image) {
  const FieldInfo& info = image.field.info;
  const std::size_t D = info.axes.size();
  for (std::size_t row = 0; row < D; ++row) {
    image.origin[row] = info.world->offset[row];
    for (std::size_t k = 0; k < D; ++k)
      image.origin[row] += info.world->linear[row * D + k] * info.axes[k].origin;
  }
  for (std::size_t k = 0; k < D; ++k) {
    const Axis& axis = info.axes[k];
    double length = 0;
    for (std::size_t row = 0; row < D; ++row)
      length = std::hypot(length, info.world->linear[row * D + k] * axis.spacing);
    for (std::size_t row = 0; row < D; ++row)
      image.direction[row * 3 + k] = info.world->linear[row * D + k] * axis.spacing / length;
    image.spacing[k] = length;
    image.low[k] = axis.first;
    image.high[k] = axis.first + axis.count - 1;
  }
}

// `step` has at most three axes, evenly spaced.
Image image_of(const Field& step) {
  Image image;
  image.field = step;
  if (step.info.world)
    place_in_world(image);
  else
    for (std::size_t k = 0; k < step.info.axes.size(); ++k) place_evenly(image, k);
  return image;
}

template <class Numbers>
std::string words(const Numbers& numbers) {
  std::string result;
  for (const auto& number : numbers) result += text(result.empty() ? "" : " ", number);
  return result;
}

void write_image(AtomicFile& file, const Field& step, std::optional<double> time) {
  const Image image = image_of(step);
  const FieldInfo& info = image.field.info;
  const std::string name = xml_escaped(info.name.empty() ? "field" : info.name);
  const std::string extent = words(
      std::array{image.low[0], image.high[0], image.low[1], image.high[1], image.low[2], image.high[2]});
  file.write(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n");
  file.write(text("<ImageData WholeExtent=\"", extent, "\" Origin=\"", words(image.origin), "\" Spacing=\"",
                  words(image.spacing), "\""));
  if (info.world) file.write(text(" Direction=\"", words(image.direction), "\""));
  file.write(">\n");
  if (time)
    file.write(text("<FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
                    "format=\"ascii\">",
                    *time, "</DataArray>\n</FieldData>\n"));
  file.write(text("<Piece Extent=\"", extent, "\">\n<PointData Scalars=\"", name, "\">\n<DataArray type=\"",
                  name_of(vtk_type(info.type)), "\" Name=\"", name, "\" format=\"binary\">"));
  CompressedArrayWriter samples(file, info.bytes());
  for_each_run(image.field, [&](std::span<const std::byte> run) { samples.append(run.data(), run.size()); });
  samples.finish();
  file.write("</DataArray>\n</PointData>\n</Piece>\n</ImageData>\n</VTKFile>\n");
}

// The field at one step, without its time axis.
Field step_of(const Field& field, std::int64_t step) {
  Field result = field.cropped(field.info.dimension() - 1, step, step + 1);
  result.info.axes.pop_back();
  result.info.has_time = false;
  result.strides.pop_back();
  if (!field.info.world) return result;
  const std::size_t D = result.info.axes.size();
  Affine world;
  for (std::size_t row = 0; row < D; ++row) {
    const double* entries = field.info.world->linear.data() + row * (D + 1);
    world.linear.insert(world.linear.end(), entries, entries + D);
    world.offset.push_back(field.info.world->offset[row]);
  }
  result.info.world = std::move(world);
  return result;
}

bool mixes_time(const FieldInfo& info) {
  if (!info.world || !info.has_time) return false;
  const std::size_t D = info.axes.size();
  const auto& linear = info.world->linear;
  for (std::size_t k = 0; k + 1 < D; ++k)
    if (linear[k * D + D - 1] != 0 || linear[(D - 1) * D + k] != 0) return true;
  return linear[D * D - 1] != 1 || info.world->offset[D - 1] != 0;
}

std::string step_name(const std::filesystem::path& path, std::int64_t step, std::int64_t steps) {
  const std::size_t width = std::max<std::size_t>(4, std::to_string(steps - 1).size());
  const std::string number = std::to_string(step);
  return path.stem().string() + "_" + std::string(width - number.size(), '0') + number + ".vti";
}

} // namespace

Status check_fits_vti(const FieldInfo& info, const std::filesystem::path& path) {
  const auto refused = [&](std::string_view what) {
    return Error{Code::file_unsupported,
                 text(path.string(), ": VTK's image data cannot hold ", what, "; .nrrd can")};
  };
  const int spatial = info.dimension() - (info.has_time ? 1 : 0);
  if (spatial < 1 || spatial > 3) return refused(text("a field with ", spatial, " axes beside time"));
  for (int k = 0; k < spatial; ++k) {
    const Axis& axis = info.axes[static_cast<std::size_t>(k)];
    if (!axis.coordinates.empty()) return refused(text("the uneven axis ", axis.name));
    if (std::max(std::abs(axis.first), std::abs(axis.first + axis.count)) > INT32_MAX)
      return refused(text("sample numbers beyond 32 bits (axis ", axis.name, ")"));
  }
  if (mixes_time(info)) return refused("an orientation that mixes time with space");
  return {};
}

void write_vti(AtomicFile& file, const Field& field) { write_image(file, field, std::nullopt); }

Status write_vti_series(const Field& field, const std::filesystem::path& path) {
  const Axis& times = field.info.axes.back();
  FileGroup group;
  std::vector<SeriesEntry> entries;
  for (std::int64_t step = 0; step < times.count; ++step) {
    const std::string name = step_name(path, step, times.count);
    auto file = AtomicFile::create(path.parent_path() / name);
    if (!file) return file.error();
    write_image(*file, step_of(field, step), times.coordinate(step));
    if (Status status = file->commit(&group); !status) return status;
    entries.push_back({times.coordinate(step), name});
  }
  if (Status status = write_series(entries, std::filesystem::path(path).replace_extension(".pvd"), &group);
      !status)
    return status;
  return group.commit();
}

} // namespace hyperiso
