// Bundles the viewer into one HTML page without data, and writes it and the extraction core compressed as a
// C++ source file.
//
//   node build.mjs OUTPUT.cpp [CORE.wasm]
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { deflateRawSync, deflateSync } from "node:zlib";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const [output, core] = process.argv.slice(2);

const bundled = async (options) => {
  const { outputFiles } = await build({
    bundle: true,
    minify: true,
    format: "iife",
    target: ["es2022"],
    write: false,
    outdir: "unused",
    legalComments: "inline",
    ...options,
  });
  return (suffix) => outputFiles.find((file) => file.path.endsWith(suffix)).text.trim();
};

// The worker is text in the page's script: a page from a disk can start it only so.
const worker = await bundled({ entryPoints: [join(here, "src/worker.ts")] });
const parts = await bundled({
  entryPoints: [join(here, "src/main.ts"), join(here, "src/page.css")],
  define: { WORKER_SOURCE: JSON.stringify(worker(".js")) },
});

// A function, so that `$` in the bundle means nothing; and nothing in a script may look like its end.
const page = readFileSync(join(here, "src/page.html"), "utf8")
  .replace("/*style*/", () => parts(".css"))
  .replace("/*script*/", () => parts(".js").replaceAll("</script", "<\\/script"));

const array = (name, bytes) => {
  const rows = [];
  for (let i = 0; i < bytes.length; i += 40) rows.push([...bytes.subarray(i, i + 40)].join(","));
  return `constexpr unsigned char ${name}[] = {\n${rows.join(",\n")}};\n`;
};
const module = core ? array("core", deflateRawSync(readFileSync(core), { level: 9 })) : "constexpr std::span<const unsigned char> core;\n";
writeFileSync(
  output,
  `// Made by viewer/build.mjs.\n#include "view/shell.hpp"\n\nnamespace hyperiso {\nnamespace {\n` +
    array("shell", deflateSync(page, { level: 9 })) + module +
    `}\nstd::span<const unsigned char> compressed_shell() { return shell; }\n` +
    `std::span<const unsigned char> compressed_core() { return core; }\n}\n`,
);
