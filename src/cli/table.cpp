#include "hyperiso/table.hpp"

#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/dispatch.hpp"
#include "cli/manual.hpp"
#include "cli/options.hpp"
#include "cli/parse.hpp"
#include "cli/surface.hpp"

#include <charconv>
#include <fmt/format.h>
#include <memory>

namespace hyperiso::cli {
namespace {

struct TableVerb {
  std::string dimension, entry;
  bool counts = false, verify = false;
  PrintOptions printing;
};

// A table made afresh, and how long that took.
template <int D>
struct TimedTable {
  Stopwatch stopwatch;
  HullTable<D> table;
  double seconds = stopwatch.seconds();
};

template <int D>
struct TableStatistics {
  std::uint64_t simplices = 0, most = 0, entries_with_most = 0;

  explicit TableStatistics(const HullTable<D>& table) {
    for (CubeLabels labels = 0; labels < HullTable<D>::entries; ++labels) {
      const std::uint64_t count = table.simplex_count(labels);
      simplices += count;
      if (count > most) entries_with_most = 0;
      most = std::max(most, count);
      if (count == most) ++entries_with_most;
    }
  }
  double mean() const { return static_cast<double>(simplices) / static_cast<double>(HullTable<D>::entries); }
};

template <int D>
Json json_of(const TimedTable<D>& timed) {
  const TableStatistics<D> statistics(timed.table);
  return {{"dimension", D},         {"entries", HullTable<D>::entries}, {"simplices", statistics.simplices},
          {"max", statistics.most}, {"mean", statistics.mean()},        {"seconds", timed.seconds}};
}

template <int D>
std::string report_of(const TimedTable<D>& timed) {
  const TableStatistics<D> statistics(timed.table);
  Report report;
  report.add("table", fmt::format("hull, {} dimensions: {} in a cell", D, simplex_noun(D - 1)));
  report.add("entries", grouped(HullTable<D>::entries));
  report.add(simplex_noun(D - 1), grouped(statistics.simplices));
  report.add("most", fmt::format("{} in an entry, in {} of them", statistics.most,
                                 grouped(statistics.entries_with_most)));
  report.add("mean", fmt::format("{:.6f}", statistics.mean()));
  report.add("took", seconds(timed.seconds) + " to generate");
  return report.text();
}

template <int D>
std::string counts_of(const HullTable<D>& table) {
  std::string lines;
  for (CubeLabels labels = 0; labels < HullTable<D>::entries; ++labels)
    lines += fmt::format("{}\n", table.simplex_count(labels));
  return lines;
}

CubeLabels parse_labels(const std::string& text, std::size_t entries) {
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  const bool binary = text.starts_with("0b") || text.starts_with("0B");
  const char* begin = text.data() + (hexadecimal || binary ? 2 : 0);
  const char* end = text.data() + text.size();
  std::uint64_t labels = 0;
  const auto [stop, problem] = std::from_chars(begin, end, labels, hexadecimal ? 16 : binary ? 2 : 10);
  if (problem != std::errc{} || stop != end || labels >= entries)
    fail_usage(hyperiso::text("--entry: '", text, "' is not a labelling: a number from 0 to ", entries - 1,
                              ", decimal, 0x... or 0b..."));
  return static_cast<CubeLabels>(labels);
}

// The corner of the cube as its coordinates, axis 0 first: "010".
template <int D>
std::string corner_name(int corner) {
  std::string name;
  for (int axis = 0; axis < D; ++axis) name += static_cast<char>('0' + (corner >> axis & 1));
  return name;
}

// A cube edge as its coordinates, with * along it: "01*".
template <int D>
std::string edge_name(int edge) {
  const CubeEdge ends = cube_edge_ends<D>(edge);
  std::string name = corner_name<D>(ends.lower);
  name[static_cast<std::size_t>(ends.axis)] = '*';
  return name;
}

template <int D>
Json json_of_entry(const HullTable<D>& table, CubeLabels labels) {
  Json simplices = Json::array();
  const auto edges = table.simplices(labels);
  for (std::size_t first = 0; first < edges.size(); first += D)
    simplices.push_back(std::vector<int>(edges.begin() + static_cast<std::ptrdiff_t>(first),
                                         edges.begin() + static_cast<std::ptrdiff_t>(first + D)));
  return {{"dimension", D}, {"labels", labels}, {"simplices", simplices}};
}

template <int D>
std::string report_of_entry(const HullTable<D>& table, CubeLabels labels) {
  std::string positive;
  for (int corner = 0; corner < 1 << D; ++corner)
    if (labels >> corner & 1) positive += (positive.empty() ? "" : " ") + corner_name<D>(corner);
  std::string out = fmt::format("labels {:#0{}x} ({:#0{}b}), + at {}\n{} {}\n", labels, (1 << D) / 4 + 2,
                                labels, (1 << D) + 2, positive.empty() ? "no corner" : positive,
                                table.simplex_count(labels), simplex_noun(D - 1));
  const auto edges = table.simplices(labels);
  for (std::size_t first = 0; first < edges.size(); first += D) {
    std::string numbers, names;
    for (std::size_t corner = 0; corner < D; ++corner) {
      numbers += fmt::format(" {:>2}", edges[first + corner]);
      names += ' ' + edge_name<D>(edges[first + corner]);
    }
    out += fmt::format(" {}   {}\n", numbers, names);
  }
  return out;
}

std::uint64_t failures_in(const TableVerification& found) {
  return found.facet_mismatches + found.manifold_failures + found.vertex_link_failures +
         found.edge_use_failures + found.orientation_failures + found.face_intersections;
}

Json json_of(const TableVerification& found) {
  return {{"entries", found.entries},
          {"facet_checks", found.facet_checks},
          {"facet_mismatches", found.facet_mismatches},
          {"interior_faces", found.interior_faces},
          {"manifold_failures", found.manifold_failures},
          {"vertex_links", found.vertex_links},
          {"vertex_link_failures", found.vertex_link_failures},
          {"edge_use_failures", found.edge_use_failures},
          {"orientation_checks", found.orientation_checks},
          {"orientation_failures", found.orientation_failures},
          {"face_pairs", found.face_pairs},
          {"face_intersections", found.face_intersections}};
}

template <int D>
std::string report_of_verification(const TableVerification& found, double duration) {
  std::string out = fmt::format("hull table in {} dimensions, {} entries, checked in {}\n", D,
                                grouped(found.entries), seconds(duration));
  const auto line = [&](std::uint64_t failures, std::uint64_t checks, const std::string& what) {
    out += fmt::format("{}  {:>4} of {:>11} {}\n", failures == 0 ? "ok    " : "FAILED", grouped(failures),
                       grouped(checks), what);
  };
  line(found.facet_mismatches, found.facet_checks,
       fmt::format("facets of cells differ from the {}-dimensional table", D - 1));
  line(found.manifold_failures, found.interior_faces, "faces inside a cell are not shared by two simplices");
  line(found.vertex_link_failures, found.vertex_links, "vertices have a neighbourhood that is no disk");
  line(found.edge_use_failures, found.entries, "entries use other edges than those that are crossed");
  line(found.orientation_failures, found.orientation_checks,
       "normals do not point from + to - along an edge");
  line(found.face_intersections, found.face_pairs, "pairs of faces can intersect");
  return out;
}

template <int D>
int verify(const TableVerb& options) {
  const HullTable<D>& table = hull_table<D>();
  const Stopwatch stopwatch;
  const TableVerification found = [&] {
    const ProgressBar bar("verify", options.printing.quiet);
    return verify_hull_table(table);
  }();
  if (options.printing.json) {
    Json object = json_of<D>(TimedTable<D>());
    object["verification"] = json_of(found);
    print_json(object);
  } else
    print(report_of_verification<D>(found, stopwatch.seconds()));
  return failures_in(found) == 0 ? 0 : exit_failure;
}

template <int D>
int show(const TableVerb& options) {
  if (options.verify) return verify<D>(options);
  if (options.counts) {
    print(counts_of(hull_table<D>()));
  } else if (!options.entry.empty()) {
    const CubeLabels labels = parse_labels(options.entry, HullTable<D>::entries);
    options.printing.json ? print_json(json_of_entry(hull_table<D>(), labels))
                          : print(report_of_entry(hull_table<D>(), labels));
  } else {
    const TimedTable<D> timed;
    options.printing.json ? print_json(json_of(timed)) : print(report_of(timed));
  }
  return 0;
}

int run(const TableVerb& options) {
  if (options.counts + options.verify + !options.entry.empty() > 1)
    fail_usage("give one of --counts, --entry and --verify");
  if (options.counts && options.printing.json) fail_usage("--counts prints numbers, one a line, and no JSON");
  const std::int64_t dimension = parse_integer("D", options.dimension);
  if (dimension < lowest_dimension || dimension > highest_dimension)
    fail_usage(text("D: there are tables for ", lowest_dimension, " to ", highest_dimension,
                    " dimensions, not for ", dimension));
  return with_dimension<lowest_dimension>(
      static_cast<int>(dimension), "the table",
      [&]<int D>(std::integral_constant<int, D>) { return show<D>(options); });
}

} // namespace

Command table_command(CLI::App& program) {
  auto options = std::make_shared<TableVerb>();
  CLI::App* app = program.add_subcommand("table", "a lookup table: statistics, an entry, verification");
  app->add_option("D", options->dimension, "the dimension: 2, 3 or 4")->required()->group("Input");
  app->add_flag("--counts", options->counts,
                "print the number of simplices of every entry, one a line, labelling 0 first; nothing else")
      ->group("Output");
  app->add_option(
         "--entry", options->entry,
         "show the entry of labelling L (decimal, 0x... or 0b...; bit i is the sample at corner i, 1 for +): "
         "its simplices as numbers of cube edges, and as their corners' coordinates with * along the edge")
      ->type_name("L")
      ->group("Output");
  app->add_flag("--verify", options->verify,
                "recompute what the table promises, for every entry, in exact arithmetic; exit code 1 if "
                "anything fails")
      ->group("Output");
  options->printing.add_to(*app);
  set_manual(
      *app,
      {{"table D [options]"},
       {"Generates the table that maps the labels (+ or -) of the 2^D corners of a cell to the simplices of "
        "the surface in "
        "it: the facets, inside the cell, of the convex hull of the + corners and the midpoints of the "
        "crossed edges "
        "(Bhaniramka, Wenger, Crawfis: Isosurfacing in Higher Dimensions, 2000). Corner i is at coordinate "
        "(bit k of i) "
        "along axis k; the edge along axis k from corner i has the number k 2^(D-1) + (i without bit k)."},
       {{"the statistics of all three tables", "hyperiso table 2"},
        {"", "hyperiso table 3"},
        {"", "hyperiso table 4"},
        {"two opposite + corners make a tunnel", "hyperiso table 3 --entry 0x18"},
        {"the proof, in numbers", "hyperiso table 4 --verify"}}});
  return {app, [options] { return run(*options); }};
}

} // namespace hyperiso::cli
