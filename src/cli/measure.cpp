#include "hyperiso/measure.hpp"

#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/failure.hpp"
#include "cli/manual.hpp"
#include "cli/options.hpp"
#include "cli/surface.hpp"
#include "hyperiso/io.hpp"

#include <fmt/format.h>
#include <memory>

namespace hyperiso::cli {
namespace {

struct MeasureVerb {
  std::string path;
  bool self_intersections = false;
  PrintOptions printing;
};

int run(const MeasureVerb& options) {
  const Mesh mesh = mesh_in(options.path, options.printing.quiet);
  const Measure measured = measure_of(mesh, options.printing.quiet);
  std::optional<SelfIntersections> intersections;
  if (options.self_intersections) intersections = self_intersections_of(mesh, options.printing.quiet);
  if (options.printing.json) {
    Json object{{"dimension", mesh.dimension},
                {"simplex_dimension", mesh.simplex_dimension},
                {"vertices", mesh.vertex_count()},
                {"simplices", mesh.simplex_count()},
                {"measure", json_of(measured)}};
    if (intersections) object["self_intersections"] = json_of(*intersections);
    print_json(object);
    return 0;
  }
  Report report;
  report.add("mesh",
             fmt::format("{} in {} dimensions", simplex_noun(mesh.simplex_dimension), mesh.dimension));
  report.add("vertices", grouped(mesh.vertex_count()));
  report.add(simplex_noun(mesh.simplex_dimension), grouped(mesh.simplex_count()));
  add_measure(report, measured, mesh.simplex_dimension);
  if (intersections) add_self_intersections(report, *intersections);
  print(report.text());
  return 0;
}

} // namespace

Command measure_command(CLI::App& program) {
  auto options = std::make_shared<MeasureVerb>();
  CLI::App* app = program.add_subcommand("measure", "checks and measures of a mesh");
  app->add_option("MESH", options->path, "the mesh: .vtu, .vtp, .ply, .stl, .obj or .off")
      ->required()
      ->group("Input");
  add_self_intersections_option(*app, options->self_intersections);
  options->printing.add_to(*app);
  set_manual(*app, {{"measure MESH [options]"},
                    {"Counts components and the Euler characteristic, checks that the mesh is a manifold "
                     "(bad facets: 0) and "
                     "where it has a boundary, and adds up its content (length, area or volume) and its "
                     "vector area (the sum of "
                     "area times normal: 0 for a closed surface). A facet is a side of a simplex: the end of "
                     "a segment, the edge of "
                     "a triangle, the face of a tetrahedron.",
                     "The triangles of an .stl share no vertices; every one of them counts as a component."},
                    {{"is this surface closed?", "hyperiso sample ball --dims 20,20,20 -o ball.nrrd"},
                     {"", "hyperiso extract ball.nrrd --iso 0.5 -o ball.ply"},
                     {"", "hyperiso measure ball.ply"},
                     {"does it pass through itself?", "hyperiso measure ball.ply --self-intersections"},
                     {"numbers for a script", "hyperiso measure ball.ply --json"}}});
  return {app, [options] { return run(*options); }};
}

} // namespace hyperiso::cli
