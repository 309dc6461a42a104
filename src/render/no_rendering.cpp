// In the place of the others where Embree or cairo was not found.

#include "hyperiso/render.hpp"

namespace hyperiso {
namespace {

Error not_built() {
  return {
      Code::file_unsupported,
      "this hyperiso was built without pictures: its build needs Embree 3 and cairo (Debian: libembree-dev, "
      "libcairo2-dev); .pvd, .ply, .vtp and .glb need neither"};
}

} // namespace

struct FilmWriter::State {};
FilmWriter::FilmWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
FilmWriter::FilmWriter(FilmWriter&&) noexcept = default;
FilmWriter::~FilmWriter() = default;

Status check_rendering() { return not_built(); }
Result<Image> render(const Mesh&, const std::string&, const RenderOptions&) { return not_built(); }
Status write_png(const Image&, const std::filesystem::path&, FileGroup*) { return not_built(); }
Result<FilmWriter> FilmWriter::create(const std::filesystem::path&, int, int, double) { return not_built(); }
Status FilmWriter::add(const Image&) { return not_built(); }
Status FilmWriter::finish() { return not_built(); }

} // namespace hyperiso
