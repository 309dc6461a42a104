// VTK's XML image data (.vti).

#include "core/determinant.hpp"
#include "core/text.hpp"
#include "io/formats.hpp"
#include "io/parse.hpp"
#include "io/stored_field.hpp"
#include "io/vtk_xml.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace hyperiso {
namespace {

// An open file: the tree, and the bytes that its arrays are decoded from.
struct VtiFile {
  std::shared_ptr<const InputFile> file;
  VtkXml xml;
};

// Sample numbers low[k] ... high[k] along each axis.
struct Extent {
  std::array<std::int64_t, 3> low, high;

  std::int64_t count(std::size_t axis) const { return high[axis] - low[axis] + 1; }
  std::uint64_t samples() const {
    return static_cast<std::uint64_t>(count(0)) * static_cast<std::uint64_t>(count(1)) *
           static_cast<std::uint64_t>(count(2));
  }
  bool contains(const Extent& other) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (other.low[axis] < low[axis] || other.high[axis] > high[axis]) return false;
    return true;
  }
  // The cells between these points; a flat image has one layer of them.
  Extent of_cells() const {
    Extent cells = *this;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (high[axis] > low[axis]) --cells.high[axis];
    return cells;
  }
  bool operator==(const Extent&) const = default;
};

struct Piece {
  Extent extent; // of the samples: points, or cells
  VtkArray array;
};

Result<Extent> extent_of(const VtkXml& xml, pugi::xml_node node, const char* attribute) {
  const std::string_view words = node.attribute(attribute).as_string();
  // 32-bit numbers: no difference of two overflows, nor does the product of two counts.
  const auto numbers = numbers_from<std::int32_t>(words);
  if (!numbers || numbers->size() != 6)
    return xml.malformed(text(attribute, " is ", in_quotes(words), ", not six whole numbers"));
  Extent extent{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    extent.low[axis] = (*numbers)[2 * axis];
    extent.high[axis] = (*numbers)[2 * axis + 1];
    if (extent.high[axis] < extent.low[axis])
      return xml.malformed(text(attribute, " is ", in_quotes(words), ": there are no samples in it"));
  }
  return extent;
}

template <std::size_t N>
Result<std::array<double, N>> numbers_of(const VtkXml& xml, pugi::xml_node node, const char* attribute,
                                         std::array<double, N> otherwise) {
  if (!node.attribute(attribute)) return otherwise;
  const std::string_view words = node.attribute(attribute).as_string();
  const auto numbers = numbers_from<double>(words);
  if (!numbers || numbers->size() != N ||
      !std::all_of(numbers->begin(), numbers->end(), [](double v) { return std::isfinite(v); }))
    return xml.malformed(text(attribute, " is ", in_quotes(words), ", not ", N, " numbers"));
  std::array<double, N> result;
  std::copy(numbers->begin(), numbers->end(), result.begin());
  return result;
}

// Nothing for integers of 64 bits.
std::optional<SampleType> sample_type_of_array(VtkType type) {
  return visit_vtk_type(type, [](auto value) -> std::optional<SampleType> {
    if constexpr (std::is_integral_v<decltype(value)> && sizeof value == 8)
      return std::nullopt;
    else
      return sample_type_of<decltype(value)>();
  });
}

// Why a field cannot be made of the array; empty if it can.
std::string objection_to(const VtkArray& array, pugi::xml_node node) {
  if (array.components > 1) return text("has ", array.components, " components");
  if (node.attribute("type").as_string() == std::string_view("String")) return "holds strings";
  if (!sample_type_of_array(array.type)) return "is of a 64-bit integer type";
  return {};
}

// The array that is asked for, or the active scalars, or the first that a field can be made of.
class ArrayChoice {
 public:
  ArrayChoice(const VtkXml& xml, const std::string& variable) : xml_(xml), variable_(variable) {}

  bool on_cells = false;
  std::string name;

  Status choose(pugi::xml_node piece) {
    for (const char* location : {"PointData", "CellData"}) {
      const auto data = piece.child(location);
      const std::string wanted = variable_.empty() ? data.attribute("Scalars").as_string() : variable_;
      on_cells = location == std::string_view("CellData");
      pugi::xml_node first;
      for (const auto node : data.children("DataArray")) {
        const std::string array_name = node.attribute("Name").as_string();
        const bool is_wanted = !wanted.empty() && array_name == wanted;
        const auto array = xml_.array(node);
        if (!array && is_wanted) return array.error();
        const std::string objection = array ? objection_to(*array, node) : "cannot be read";
        if (!array) error_ = array.error();
        seen_ += text(seen_.empty() ? "" : ", ", in_quotes(array_name),
                      objection.empty() ? "" : " (which " + objection + ")");
        if (is_wanted && !variable_.empty() && !objection.empty())
          return xml_.unsupported(
              text("the array ", in_quotes(wanted), " ", objection,
                   "; a field is made of numbers of at most 32 bits, f32 or f64, one for each "
                   "point or cell"));
        if (!objection.empty()) continue;
        if (is_wanted) return name = array_name, Status{};
        if (!first) first = node;
      }
      if (variable_.empty() && first) return name = first.attribute("Name").as_string(), Status{};
    }
    if (!variable_.empty())
      return Error{Code::invalid_argument,
                   xml_.malformed(text("no array is called ", in_quotes(variable_), "; there are ",
                                       seen_.empty() ? "none" : seen_))
                       .message};
    if (error_) return *error_;
    return xml_.unsupported(text("there is no array that a field can be made of: ",
                                 seen_.empty() ? "the file has no point or cell data" : seen_));
  }

 private:
  const VtkXml& xml_;
  const std::string& variable_;
  std::string seen_;
  std::optional<Error> error_; // of an array that nobody asked for
};

Result<std::vector<Piece>> pieces_of(const VtkXml& xml, pugi::xml_node image, const ArrayChoice& choice) {
  std::vector<Piece> pieces;
  for (const auto node : image.children("Piece")) {
    const auto extent = extent_of(xml, node, "Extent");
    if (!extent) return extent.error();
    pugi::xml_node found;
    for (const auto array : node.child(choice.on_cells ? "CellData" : "PointData").children("DataArray"))
      if (array.attribute("Name").as_string() == choice.name) found = array;
    if (!found) return xml.malformed(text("a piece lacks the array ", in_quotes(choice.name)));
    auto array = xml.array(found);
    if (!array) return array.error();
    if (array->components != 1 || (!pieces.empty() && array->type != pieces[0].array.type))
      return xml.malformed(text("the array ", in_quotes(choice.name), " differs between the pieces"));
    Piece piece{choice.on_cells ? extent->of_cells() : *extent, std::move(*array)};
    if (piece.extent.samples() != piece.array.values)
      return xml.malformed(text("the array ", in_quotes(choice.name), " holds ", piece.array.values,
                                " values, but its extent has ", piece.extent.samples(), " samples"));
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

// Every sample of the whole must be in a piece. Requires that the pieces hold as many values as their extents
// have samples, which the file accounts for.
Status check_cover(const VtkXml& xml, const Extent& whole, const std::vector<Piece>& pieces) {
  if (pieces.size() == 1 && pieces[0].extent == whole) return {};
  std::uint64_t values = 0;
  for (const Piece& piece : pieces) {
    if (!whole.contains(piece.extent)) return xml.malformed("a piece lies outside the WholeExtent");
    values += piece.array.values;
  }
  const Error gap = xml.malformed("the pieces do not cover the WholeExtent");
  if (values < whole.samples()) return gap;
  std::vector<bool> covered(whole.samples());
  for (const Piece& piece : pieces)
    for (std::int64_t z = piece.extent.low[2]; z <= piece.extent.high[2]; ++z)
      for (std::int64_t y = piece.extent.low[1]; y <= piece.extent.high[1]; ++y) {
        const std::int64_t row = (z - whole.low[2]) * whole.count(1) + y - whole.low[1];
        const auto begin = covered.begin() + row * whole.count(0) + piece.extent.low[0] - whole.low[0];
        std::fill(begin, begin + piece.extent.count(0), true);
      }
  if (std::find(covered.begin(), covered.end(), false) != covered.end()) return gap;
  return {};
}

// Decoded array by array; in place where one uncompressed array is everything.
class VtiSource final : public ByteSource {
 public:
  VtiSource(VtiFile file, Extent whole, std::vector<Piece> pieces, std::uint64_t memory_limit)
      : file_(std::move(file)), whole_(whole), pieces_(std::move(pieces)), memory_limit_(memory_limit) {}

  std::shared_ptr<const std::byte> in_place(std::uint64_t offset, std::uint64_t) override {
    const VtkArray& array = pieces_[0].array;
    const bool big_endian =
        file_.xml.root().attribute("byte_order").as_string() == std::string_view("BigEndian");
    const bool as_it_lies =
        pieces_.size() == 1 && array.encoding == VtkArray::Encoding::raw && array.block_bytes == 0 &&
        (size_of(array.type) == 1 || big_endian == (std::endian::native == std::endian::big));
    if (!as_it_lies || array.header_bytes + array.bytes() > array.content.size()) return nullptr;
    const char* start = array.content.data() + array.header_bytes + offset;
    return {file_.file, reinterpret_cast<const std::byte*>(start)};
  }

  Status read(std::uint64_t offset, std::span<std::byte> out) override {
    if (pieces_.size() == 1 && out.size() == pieces_[0].array.bytes())
      return file_.xml.read(pieces_[0].array, out.data());
    for (const Piece& piece : pieces_)
      if (Status status = copy_piece(piece, offset, out); !status) return status;
    return {};
  }

 private:
  // Copies those rows of the piece that lie in [offset, offset + out.size()) of the whole.
  Status copy_piece(const Piece& piece, std::uint64_t offset, std::span<std::byte> out) {
    const std::uint64_t width = size_of(piece.array.type),
                        row = static_cast<std::uint64_t>(piece.extent.count(0)) * width;
    std::vector<std::byte> decoded; // not before a row of it is needed
    std::uint64_t from = 0;
    for (std::int64_t z = piece.extent.low[2]; z <= piece.extent.high[2]; ++z)
      for (std::int64_t y = piece.extent.low[1]; y <= piece.extent.high[1]; ++y, from += row) {
        const std::int64_t whole_row = (z - whole_.low[2]) * whole_.count(1) + y - whole_.low[1];
        const auto sample = whole_row * whole_.count(0) + piece.extent.low[0] - whole_.low[0];
        const std::uint64_t start = static_cast<std::uint64_t>(sample) * width;
        const std::uint64_t begin = std::max(start, offset), end = std::min(start + row, offset + out.size());
        if (begin >= end) continue;
        if (decoded.empty())
          if (Status status = decode(piece.array, decoded); !status) return status;
        std::memcpy(out.data() + (begin - offset), decoded.data() + from + (begin - start), end - begin);
      }
    return {};
  }
  Status decode(const VtkArray& array, std::vector<std::byte>& decoded) const {
    if (array.bytes() > memory_limit_)
      return Error{Code::out_of_memory,
                   text(file_.file->path().string(), ": an array of ", byte_size(array.bytes()),
                        " has to be decoded as a whole; the memory limit is ", byte_size(memory_limit_))};
    decoded.resize(array.bytes());
    return file_.xml.read(array, decoded.data());
  }

  VtiFile file_;
  Extent whole_;
  std::vector<Piece> pieces_;
  std::uint64_t memory_limit_;
};

// Axes of one sample are left out, where one of more is left: a flat image is a field of two dimensions. The
// affine map is kept if it does not mix the axes left out with the others.
void leave_out_flat_axes(StoredField& field) {
  std::vector<std::size_t> kept;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (field.axes[axis].count > 1) kept.push_back(axis);
  if (kept.empty()) kept.push_back(0);

  const auto is_kept = [&](std::size_t axis) { return std::ranges::find(kept, axis) != kept.end(); };
  if (field.world) {
    Affine world;
    bool mixes = false;
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 3; ++column) {
        const double entry = field.world->linear[row * 3 + column];
        mixes = mixes || (is_kept(row) != is_kept(column) && entry != 0);
        if (is_kept(row) && is_kept(column)) world.linear.push_back(entry);
      }
    for (const std::size_t axis : kept) world.offset.push_back(field.world->offset[axis]);
    if (mixes)
      field.world.reset();
    else
      field.world = std::move(world);
  }
  std::vector<Axis> axes;
  for (const std::size_t axis : kept) axes.push_back(std::move(field.axes[axis]));
  field.axes = std::move(axes);
}

// Where the samples are: the point (or the centre of the cell) i along axis k is at
// Origin + Direction * (Spacing * i).
Status place_axes(const VtkXml& xml, pugi::xml_node image, const Extent& extent, const Extent& points,
                  bool on_cells, StoredField& field) {
  const auto origin = numbers_of<3>(xml, image, "Origin", {0, 0, 0});
  if (!origin) return origin.error();
  const auto spacing = numbers_of<3>(xml, image, "Spacing", {1, 1, 1});
  if (!spacing) return spacing.error();
  const auto direction = numbers_of<9>(xml, image, "Direction", {1, 0, 0, 0, 1, 0, 0, 0, 1});
  if (!direction) return direction.error();
  const std::vector<double> linear(direction->begin(), direction->end());
  if (determinant(linear, 3) == 0) return xml.malformed("the Direction does not span the space");
  bool diagonal = true;
  for (std::size_t i = 0; i < 9; ++i) diagonal = diagonal && (i % 4 == 0 || linear[i] == 0);

  field.axes.resize(3);
  for (std::size_t k = 0; k < 3; ++k) {
    Axis& axis = field.axes[k];
    axis.name = std::string(1, "xyz"[k]);
    axis.count = extent.count(k);
    axis.first = extent.low[k];
    axis.spacing = diagonal ? (*spacing)[k] * linear[4 * k] : (*spacing)[k];
    axis.origin = diagonal ? (*origin)[k] : 0;
    if (axis.spacing == 0 && axis.count == 1) axis.spacing = 1; // flat images may have none
    if (axis.spacing == 0) return xml.malformed(text("the Spacing along ", axis.name, " is 0"));
    if (on_cells && points.count(k) > 1) axis.origin += axis.spacing / 2;
  }
  if (!diagonal) field.world = Affine{linear, {origin->begin(), origin->end()}};
  return {};
}

std::optional<double> time_of(const VtkXml& xml, pugi::xml_node image) {
  for (const auto node : image.child("FieldData").children("DataArray"))
    if (node.attribute("Name").as_string() == std::string_view("TimeValue"))
      if (const auto array = xml.array(node); array && array->values == 1)
        return visit_vtk_type(array->type, [&](auto value) -> std::optional<double> {
          if (!xml.read(*array, &value) || !std::isfinite(static_cast<double>(value))) return std::nullopt;
          return static_cast<double>(value);
        });
  return std::nullopt;
}

} // namespace

Result<OpenStep> open_vti_step(const std::filesystem::path& path, const ReadOptions& options) {
  auto file = InputFile::open(path);
  if (!file) return file.error();
  auto xml = VtkXml::parse((*file)->characters(), path.string());
  if (!xml) return xml.error();
  const std::string_view kind = xml->root().attribute("type").as_string();
  const auto image = xml->root().child("ImageData");
  if (kind != "ImageData" || !image)
    return xml->unsupported(text("the file holds ", in_quotes(kind), "; fields are read from ImageData"));

  const auto points = extent_of(*xml, image, "WholeExtent");
  if (!points) return points.error();
  if (!image.child("Piece")) return xml->malformed("there is no Piece in it");
  ArrayChoice choice(*xml, options.variable);
  if (Status status = choice.choose(image.child("Piece")); !status) return status.error();
  auto pieces = pieces_of(*xml, image, choice);
  if (!pieces) return pieces.error();
  const Extent extent = choice.on_cells ? points->of_cells() : *points;

  StoredField field;
  field.name = choice.name;
  field.type = *sample_type_of_array((*pieces)[0].array.type);
  if (Status status = place_axes(*xml, image, extent, *points, choice.on_cells, field); !status)
    return status.error();
  if (const auto bytes = bytes_of(field.axes, field.type, path); !bytes) return bytes.error();
  if (Status status = check_cover(*xml, extent, *pieces); !status) return status.error();
  leave_out_flat_axes(field);

  const auto time = time_of(*xml, image);
  auto source = std::make_unique<VtiSource>(VtiFile{std::move(*file), std::move(*xml)}, extent,
                                            std::move(*pieces), options.memory_limit);
  auto reader = read_stored(std::move(field), std::move(source), false, path, options);
  if (!reader) return reader.error();
  return OpenStep{std::move(*reader), time};
}

} // namespace hyperiso
