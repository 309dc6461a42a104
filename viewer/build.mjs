// Bundles the viewer into one HTML page without data, and writes it compressed as a C++ source file.
//
//   node build.mjs OUTPUT.cpp
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { deflateSync } from "node:zlib";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));

const bundle = await build({
  entryPoints: [join(here, "src/main.ts"), join(here, "src/page.css")],
  bundle: true,
  minify: true,
  format: "iife",
  target: ["es2022"],
  write: false,
  outdir: "unused",
  legalComments: "inline",
});
const bundled = (suffix) => bundle.outputFiles.find((file) => file.path.endsWith(suffix)).text;

// A function, so that `$` in the bundle means nothing; and nothing in a script may look like its end.
const page = readFileSync(join(here, "src/page.html"), "utf8")
  .replace("/*style*/", () => bundled(".css").trim())
  .replace("/*script*/", () => bundled(".js").trim().replaceAll("</script", "<\\/script"));

const bytes = deflateSync(page, { level: 9 });
const rows = [];
for (let i = 0; i < bytes.length; i += 40) rows.push([...bytes.subarray(i, i + 40)].join(","));
writeFileSync(
  process.argv[2],
  `// Made by viewer/build.mjs.\n#include "view/shell.hpp"\n\nnamespace hyperiso {\nnamespace {\n` +
    `constexpr unsigned char shell[] = {\n${rows.join(",\n")}};\n}\n` +
    `std::span<const unsigned char> compressed_shell() { return shell; }\n}\n`,
);
