// A field and the measure of a tetrahedron, with nothing but the installed headers.
#include <hyperiso/hyperiso.hpp>

#include <cstdio>

int main() {
  using namespace hyperiso;
  FieldInfo info;
  info.axes.resize(4);
  for (Axis& axis : info.axes) axis.count = 8;
  const auto field = allocate_field(info);
  if (!field) return std::fprintf(stderr, "%s\n", field.error().message.c_str()), 1;

  Mesh tetrahedron(4, 3);
  tetrahedron.positions.reset(16, false);
  for (std::size_t i = 0; i < 16; ++i) tetrahedron.positions.set(i, i % 5 == 4 ? 1 : 0);
  tetrahedron.simplices.reset(4, false);
  for (std::size_t i = 0; i < 4; ++i) tetrahedron.simplices.set(i, i);
  const auto measured = measure(tetrahedron);
  if (!measured) return std::fprintf(stderr, "%s\n", measured.error().message.c_str()), 1;
  std::printf("%lld samples, Euler characteristic %lld\n",
              static_cast<long long>(field->field.info.samples()),
              static_cast<long long>(measured->euler_characteristic));
  return measured->euler_characteristic == 1 ? 0 : 1;
}
