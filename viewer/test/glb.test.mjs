// The .glb that `hyperiso animate` writes: valid to the Khronos validator, and one frame at a time in three.js.
//
//   HYPERISO=PROGRAM node --test viewer/test/glb.test.mjs
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { after, before, describe, test } from "node:test";
import { fileURLToPath } from "node:url";
import { buildSync } from "esbuild";
import validator from "gltf-validator";
import { openBrowser } from "./browser.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const folder = mkdtempSync(join(tmpdir(), "hyperiso-glb-"));
const hyperiso = (...words) => execFileSync(process.env.HYPERISO, words, { cwd: folder, stdio: ["ignore", "pipe", "pipe"] });
let browser, page;

before(async () => {
  hyperiso("sample", "torus-morph", "--dims", "16,16,16,9", "-o", "torus.nrrd");
  hyperiso("sample", "gaussians", "--dims", "16,16,16,7", "-o", "blobs.nrrd");
  hyperiso("sample", "ball", "--dims", "16,16,5", "--time", "-o", "disc.nrrd");
  browser = await openBrowser();
  page = await browser.newPage();
  const bundle = buildSync({ entryPoints: [join(here, "glb_page.ts")], bundle: true, write: false, format: "iife" });
  await page.evaluate(bundle.outputFiles[0].text);
});
after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true });
});

function animate(name, ...words) {
  hyperiso("animate", ...words, "-o", name);
  return readFileSync(join(folder, name));
}

async function assertValid(bytes) {
  const report = await validator.validateBytes(new Uint8Array(bytes), { maxIssues: 20 });
  assert.deepEqual(report.issues.messages.filter((message) => message.severity < 2), [], "errors and warnings");
  return report.info;
}

const json = (bytes) => JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)).toString());
const shown = (bytes, times) => page.evaluate(([data, at]) => window.glb.shown(data, at), [bytes.toString("base64"), times]);
const points = (bytes, time) => page.evaluate(([data, at]) => window.glb.points(data, at), [bytes.toString("base64"), time]);
const near = (a, b, tolerance) => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);

describe("a film of frames", () => {
  const frames = 9, perSecond = 10;
  let bytes;
  before(() => { bytes = animate("torus.glb", "torus.nrrd", "--iso", "0.5", "--frames", String(frames)); });

  test("is valid glTF", async () => {
    const info = await assertValid(bytes);
    assert.equal(info.animationCount, 1);
    assert.equal(info.extensionsUsed, undefined);
  });

  test("shows one frame at every moment, in their order and with their times", async () => {
    const times = [];
    for (let i = 0; i < frames; ++i) times.push((i + 0.02) / perSecond, (i + 0.98) / perSecond);
    const seen = await shown(bytes, times);
    seen.forEach((list, k) => {
      assert.equal(list.length, 1, `at ${times[k]} s`);
      assert.equal(list[0].name, `frame_${Math.floor(k / 2)}`); // three.js puts _ for blanks
      near(list[0].time, Math.floor(k / 2) / 4, 1e-12);
    });
  });

  test("stands upright: z of the data is y, and numbers stay as they are", async () => {
    const [[first]] = await shown(bytes, [0]); // a sphere
    const [[last]] = await shown(bytes, [0.85]); // two spheres side by side along x
    for (let k = 0; k < 3; ++k) near(first.high[k], -first.low[k], 0.05);
    assert.ok(last.high[0] - last.low[0] > 1.2 * (last.high[1] - last.low[1]));
  });

  test("where nothing is played shows the first frame", () => {
    const visible = json(bytes).nodes.filter((node) => node.name.startsWith("frame") && !node.scale);
    assert.deepEqual(visible.map((node) => node.name), ["frame 0"]);
  });

  test("normals have length 1 and look outward", () => {
    const { accessors, bufferViews, meshes } = json(bytes);
    const start = 20 + bytes.readUInt32LE(12) + 8;
    const numbers = (accessor) => {
      const { byteOffset } = bufferViews[accessors[accessor].bufferView];
      return Array.from({ length: 3 * accessors[accessor].count }, (_, i) => bytes.readFloatLE(start + byteOffset + 4 * i));
    };
    const { POSITION, NORMAL } = meshes[0].primitives[0].attributes; // the sphere
    const positions = numbers(POSITION), normals = numbers(NORMAL);
    for (let i = 0; i < positions.length; i += 3) {
      near(Math.hypot(...normals.slice(i, i + 3)), 1, 1e-5);
      assert.ok(positions[i] * normals[i] + positions[i + 1] * normals[i + 1] + positions[i + 2] * normals[i + 2] > 0);
    }
  });

  test("quantised it is half as large and looks the same", async () => {
    const small = animate("small.glb", "torus.nrrd", "--iso", "0.5", "--frames", String(frames), "--quantise");
    const info = await assertValid(small);
    assert.deepEqual(info.extensionsUsed, ["KHR_mesh_quantization"]);
    assert.ok(small.length < 0.72 * bytes.length, `${small.length} of ${bytes.length} bytes`);
    const [[a], [b]] = [await shown(bytes, [0.42]), await shown(small, [0.42])].map((seen) => seen[0]);
    assert.equal(a.name, b.name);
    for (let k = 0; k < 3; ++k) {
      near(a.low[k], b.low[k], 1e-4);
      near(a.high[k], b.high[k], 1e-4);
    }
  });
});

describe("frames that move", () => {
  const surface = ["torus.nrrd", "--iso", "0.5"];
  const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  const nearest = (point, others) => Math.min(...others.map((other) => distance(point, other)));
  let bytes;
  before(() => { bytes = animate("morph.glb", ...surface, "--frames", "9", "--morph"); });

  test("are valid glTF, with a target that moves evenly for every frame but the last", async () => {
    const info = await assertValid(bytes);
    assert.equal(info.hasMorphTargets, true);
    const { animations: [{ channels, samplers }], meshes } = json(bytes);
    assert.equal(meshes.filter(({ primitives: [{ targets }] }) => targets?.length === 1 && "POSITION" in targets[0] && "NORMAL" in targets[0]).length, 8);
    assert.equal(meshes.at(-1).primitives[0].targets, undefined);
    const moving = channels.filter(({ target }) => target.path === "weights");
    assert.equal(moving.length, 8);
    for (const { sampler } of moving) assert.equal(samplers[sampler].interpolation, "LINEAR");
  });

  test("one is shown at every moment, by its share of the way", async () => {
    const times = [];
    for (let i = 0; i < 9; ++i) times.push((i + 0.02) / 10, (i + 0.5) / 10, (i + 0.98) / 10);
    const seen = await shown(bytes, times);
    seen.forEach((list, k) => {
      const frame = Math.floor(k / 3);
      assert.deepEqual(list.map(({ name }) => name), [`frame_${frame}`]);
      if (frame < 8) near(list[0].weights[0], [0.02, 0.5, 0.98][k % 3], 1e-3);
    });
  });

  test("vertices are on the slice of the moment, but for those that have come to the end of their edge", async () => {
    const short = ["--times", "0.3,0.302", "--morph"];
    const exact = await points(animate("exact.glb", ...surface, "--times", "0.301"), 0);
    for (const more of [[], ["--quantise"]]) {
      const moving = animate("short.glb", ...surface, ...short, ...more);
      await assertValid(moving);
      const tolerance = more.length ? 1e-4 : 1e-6;
      const there = (list) => list.filter((point) => nearest(point, exact) < tolerance).length / list.length;
      const start = there(await points(moving, 0)), halfway = there(await points(moving, 0.05));
      assert.ok(halfway > 0.9 && start < 0.5, `${halfway} of the vertices are there halfway, ${start} at the start`);
    }
  });

  test("start where the frame of a stored step is", async () => {
    const still = await points(animate("still.glb", ...surface, "--times", "0.5"), 0);
    for (const point of await points(bytes, 0.2 + 1e-6)) near(nearest(point, still), 0, 1e-4);
  });

  test("with tracks, events, and quantised; without normals; in the plane", async () => {
    const tracks = animate("tracks.glb", "blobs.nrrd", "--iso", "0.5", "--frames", "5", "--events", "--tracks", "--morph", "--quantise");
    await assertValid(tracks);
    const [[frame]] = await shown(tracks, [0.28]);
    assert.ok(frame.parts.length > 1 && frame.weights.length === frame.parts.length);
    assert.ok(frame.weights[0] > 0 && frame.weights.every((weight) => weight === frame.weights[0]));
    hyperiso("extract", "blobs.nrrd", "--iso", "0.5", "-o", "surface.vtu");
    await assertValid(animate("mesh.glb", "surface.vtu", "--frames", "5", "--morph"));
    await assertValid(animate("disc.glb", "disc.nrrd", "--iso", "0.5", "--frames", "5", "--morph"));
    await assertValid(animate("none.glb", "torus.nrrd", "--iso", "7", "--frames", "3", "--quiet", "--morph"));
    await assertValid(animate("single.glb", "torus.nrrd", "--iso", "0.5", "--frames", "1", "--morph"));
  });
});

describe("other films", () => {
  test("with a frame at every event the time goes on evenly", async () => {
    const bytes = animate("events.glb", "blobs.nrrd", "--iso", "0.5", "--frames", "5", "--events");
    await assertValid(bytes);
    const nodes = json(bytes).nodes.filter((node) => node.name.startsWith("frame"));
    assert.ok(nodes.length > 5);
    const times = nodes.map((node) => node.extras.time);
    const seconds = (time) => ((time - times[0]) / (times.at(-1) - times[0])) * (nodes.length - 1) / 10;
    for (const [i, time] of times.entries()) {
      const [list] = await shown(bytes, [seconds(time) + 1e-3]);
      assert.deepEqual(list.map((frame) => frame.name), [`frame_${i}`]);
    }
  });

  test("colours by a coordinate", async () => {
    const bytes = animate("colours.glb", "blobs.nrrd", "--iso", "0.5", "--frames", "3", "--colour-by", "z");
    await assertValid(bytes);
    const { accessors, meshes } = json(bytes);
    const colours = accessors[meshes[0].primitives[0].attributes.COLOR_0];
    assert.deepEqual([colours.type, colours.componentType, colours.normalized], ["VEC4", 5123, true]);
  });

  test("curves in the plane are lines", async () => {
    const bytes = animate("disc.glb", "disc.nrrd", "--iso", "0.5", "--frames", "5");
    await assertValid(bytes);
    assert.equal(json(bytes).meshes[0].primitives[0].mode, 1);
    assert.equal((await shown(bytes, [0.25]))[0].length, 1);
  });

  test("frames without a surface, and a single frame", async () => {
    await assertValid(animate("none.glb", "torus.nrrd", "--iso", "7", "--frames", "3", "--quiet"));
    const single = animate("single.glb", "torus.nrrd", "--iso", "0.5", "--frames", "1");
    await assertValid(single);
    assert.equal((await shown(single, [0]))[0].length, 1);
  });
});
