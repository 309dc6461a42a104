// Where surfaces are extracted: a worker, so that the page goes on. It has the library's extraction as a
// WebAssembly module (src/view/wasm/module.cpp) and nothing of the page.
import { boxesOf, type Mesh, normalsOf } from "./mesh";
import type { Metadata } from "./metadata";
import { Space } from "./space";

/// What the page sends: first the module, then the samples, then isovalues as codes.
export type Order =
  | { kind: "open"; module: Uint8Array; metadata: Metadata }
  | { kind: "layers"; count: number; bytes: Uint8Array }
  | { kind: "histogram"; bins: number }
  | { kind: "extract"; isovalue: number };

/// What the worker sends back.
export type Reply =
  | { kind: "progress"; share: number }
  | { kind: "histogram"; counts: number[]; low: number; high: number } // of codes
  | { kind: "mesh"; mesh: Mesh }
  | { kind: "failed"; message: string };

interface Core {
  memory: WebAssembly.Memory;
  _initialize(): void;
  room(bytes: number): number;
  add_axis(count: number, first: number, origin: number, spacing: number, uneven: number, minimum: number, maximum: number): void;
  set_world(): void;
  set_samples(narrow: number, special: number, band: number, below: number, firstClass: number, isovalue: number,
    timeSlabs: number, method: number): void;
  add_layers(count: number): number;
  codes(): number;
  code_count(): number;
  extract(isovalue: number): number;
  levels(): number;
  vertex_count(): number;
  simplices(): number;
  simplex_count(): number;
}

const post = (reply: Reply, transfer: Transferable[] = []): void =>
  (self as unknown as { postMessage(message: Reply, transfer: Transferable[]): void }).postMessage(reply, transfer);

let core: Core;
let metadata: Metadata;

function give(bytes: Uint8Array): void {
  const room = core.room(bytes.length); // may grow the memory, whose buffer is another then
  new Uint8Array(core.memory.buffer, room, bytes.length).set(bytes);
}
const giveNumbers = (numbers: readonly number[]): void => give(new Uint8Array(new Float64Array(numbers).buffer));

async function open(module: Uint8Array, given: Metadata): Promise<void> {
  metadata = given;
  const samples = metadata.samples!;
  const imports = { page: { progress: (share: number) => post({ kind: "progress", share }) } };
  core = (await WebAssembly.instantiate(module as BufferSource, imports)).instance.exports as unknown as Core;
  core._initialize();
  samples.axes.forEach((axis, k) => {
    if (axis.coordinates) giveNumbers(axis.coordinates);
    const { minimum, maximum } = metadata.axes[k]!;
    core.add_axis(axis.count, axis.first, axis.origin, axis.spacing, Number(Boolean(axis.coordinates)), minimum, maximum);
  });
  if (samples.world) {
    giveNumbers([...samples.world.linear, ...samples.world.offset]);
    core.set_world();
  }
  core.set_samples(Number(samples.narrow), Number(samples.special), Number(samples.band), Number(samples.inside === "below"),
    samples.firstClass, samples.isovalue, Number(metadata.time && metadata.dimension === 4), samples.method);
}

function addLayers(count: number, bytes: Uint8Array): void {
  give(bytes);
  if (!core.add_layers(count)) throw new Error("a part of the samples is damaged");
}

function histogram(bins: number): Reply {
  const counts = new Array<number>(bins).fill(0);
  const codes = new Uint16Array(core.memory.buffer, core.codes(), core.code_count());
  const { narrow, special } = metadata.samples!;
  const top = narrow ? 255 : special ? 65532 : 65535;
  let low = top, high = 0;
  for (const code of codes) {
    if (code > top) continue;
    if (code < low) low = code;
    if (code > high) high = code;
  }
  const stride = Math.max(1, Math.floor(codes.length / 500_000));
  for (let i = 0; i < codes.length; i += stride) {
    const bin = Math.floor(((codes[i]! - low) * bins) / (high - low + 1));
    if (codes[i]! <= top) ++counts[bin]!;
  }
  return { kind: "histogram", counts, low, high };
}

function extract(isovalue: number): void {
  if (!core.extract(isovalue)) throw new Error("the extraction failed");
  const vertexCount = core.vertex_count(), simplexCount = core.simplex_count();
  const shape = {
    corners: metadata.dimension as 3 | 4,
    vertexCount,
    simplexCount,
    levels: new Uint16Array(core.memory.buffer, core.levels(), 4 * vertexCount).slice(),
    simplices: new Uint32Array(core.memory.buffer, core.simplices(), 4 * simplexCount).slice(),
    attributes: [],
  };
  const mesh = { ...shape, boxes: boxesOf(shape), normals: normalsOf(shape, new Space(metadata)) };
  post({ kind: "mesh", mesh }, [mesh.levels.buffer, mesh.simplices.buffer, mesh.boxes.buffer, mesh.normals.buffer]);
}

async function obey(order: Order): Promise<void> {
  if (order.kind === "open") await open(order.module, order.metadata);
  else if (order.kind === "layers") addLayers(order.count, order.bytes);
  else if (order.kind === "histogram") post(histogram(order.bins));
  else extract(order.isovalue);
}

// One after the other, in the order in which they came, though the first takes its time.
let done = Promise.resolve();
let broken = false; // without its samples nothing can be done
addEventListener("message", (event) => {
  const order = event.data as Order;
  done = done.then(() => (broken ? undefined : obey(order))).catch((error: unknown) => {
    broken = order.kind !== "extract";
    const trapped = error instanceof WebAssembly.RuntimeError || error instanceof RangeError;
    post({ kind: "failed", message: trapped ? "not enough memory for this surface" : (error as Error).message });
  });
});
