// What can be taken away from the page.
import { type App, element } from "./app";
import { zip } from "./bytes";
import type { Triangles } from "./slice";

const FRAMES = 60;

function download(name: string, blob: Blob): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/// The slice in the axes' own coordinates as far as the picture runs along axes, else in those of the scene;
/// without the triangles that have two corners at one place, as there are where the plane runs through vertices.
function coordinates(app: App, all: Triangles): Float32Array {
  const triangles = withoutCollapsed(all);
  const axes = [0, 1, 2].map((row) => app.state.frame[row]!.findIndex((x) => x === 1));
  const result = new Float32Array(9 * triangles.count);
  for (let i = 0; i < result.length; ++i) {
    const axis = axes[i % 3]!;
    const value = triangles.positions[i]!;
    result[i] = axis >= 0 && axis < app.space.dimension ? app.space.coordinate(axis, value) : value;
  }
  return orientedOutward(result, triangles);
}

/// Swaps two corners where a triangle runs against the normals of the surface.
function orientedOutward(positions: Float32Array, triangles: Pick<Triangles, "normals">): Float32Array {
  const { normals } = triangles;
  for (let at = 0; at < positions.length; at += 9) {
    const p = positions;
    const u = [0, 1, 2].map((k) => p[at + 3 + k]! - p[at + k]!), v = [0, 1, 2].map((k) => p[at + 6 + k]! - p[at + k]!);
    const normal = [u[1]! * v[2]! - u[2]! * v[1]!, u[2]! * v[0]! - u[0]! * v[2]!, u[0]! * v[1]! - u[1]! * v[0]!];
    let against = 0;
    for (let i = 0; i < 9; ++i) against += normal[i % 3]! * normals[at + i]!;
    if (against >= 0) continue;
    for (let k = 0; k < 3; ++k) [p[at + 3 + k], p[at + 6 + k]] = [p[at + 6 + k]!, p[at + 3 + k]!];
  }
  return positions;
}

/// Corners at one place become one: what a slice of a welded surface shares, it shares to the bit.
function welded(positions: Float32Array): { points: Float32Array; index: Uint32Array } {
  const bits = new Uint32Array(positions.buffer, positions.byteOffset, positions.length);
  const known = new Map<string, number>();
  const points: number[] = [];
  const index = new Uint32Array(positions.length / 3);
  for (let i = 0; i < index.length; ++i) {
    const key = `${bits[3 * i]},${bits[3 * i + 1]},${bits[3 * i + 2]}`;
    let number = known.get(key);
    if (number === undefined) {
      known.set(key, (number = known.size));
      points.push(positions[3 * i]!, positions[3 * i + 1]!, positions[3 * i + 2]!);
    }
    index[i] = number;
  }
  return { points: new Float32Array(points), index };
}

function stl(positions: Float32Array): Blob {
  const count = positions.length / 9;
  const view = new DataView(new ArrayBuffer(84 + 50 * count));
  view.setUint32(80, count, true);
  for (let triangle = 0; triangle < count; ++triangle) {
    // The normal stays 0: readers compute it from the corners.
    for (let i = 0; i < 9; ++i) view.setFloat32(84 + 50 * triangle + 12 + 4 * i, positions[9 * triangle + i]!, true);
  }
  return new Blob([view.buffer], { type: "model/stl" });
}

function ply(positions: Float32Array): Blob {
  const { points, index } = welded(positions);
  const header = "ply\nformat binary_little_endian 1.0\ncomment hyperiso\n" +
    `element vertex ${points.length / 3}\nproperty float x\nproperty float y\nproperty float z\n` +
    `element face ${index.length / 3}\nproperty list uchar int vertex_indices\nend_header\n`;
  const view = new DataView(new ArrayBuffer(4 * points.length + (13 * index.length) / 3));
  points.forEach((x, i) => view.setFloat32(4 * i, x, true));
  for (let face = 0; face < index.length / 3; ++face) {
    const at = 4 * points.length + 13 * face;
    view.setUint8(at, 3);
    for (let i = 0; i < 3; ++i) view.setInt32(at + 1 + 4 * i, index[3 * face + i]!, true);
  }
  return new Blob([header, view.buffer]);
}

/// glTF has y up; the slice's third axis becomes that.
export function glb(positions: Float32Array): Blob {
  const { points, index } = welded(positions);
  const ends = [0, 1, 2].map((k) => {
    let low = Infinity, high = -Infinity;
    for (let i = k; i < points.length; i += 3) {
      low = Math.min(low, points[i]!);
      high = Math.max(high, points[i]!);
    }
    return [low, high] as const;
  });
  const json = JSON.stringify({
    asset: { version: "2.0", generator: "hyperiso" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0, rotation: [-Math.SQRT1_2, 0, 0, Math.SQRT1_2] }],
    materials: [{ doubleSided: true, pbrMetallicRoughness: { baseColorFactor: [0.15, 0.4, 0.85, 1], metallicFactor: 0, roughnessFactor: 0.6 } }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1, material: 0 }] }],
    buffers: [{ byteLength: points.byteLength + index.byteLength }],
    bufferViews: [
      { buffer: 0, byteOffset: 0, byteLength: points.byteLength, target: 34962 },
      { buffer: 0, byteOffset: points.byteLength, byteLength: index.byteLength, target: 34963 },
    ],
    accessors: [
      { bufferView: 0, componentType: 5126, count: points.length / 3, type: "VEC3", min: ends.map((e) => e[0]), max: ends.map((e) => e[1]) },
      { bufferView: 1, componentType: 5125, count: index.length, type: "SCALAR" },
    ],
  });
  const text = new TextEncoder().encode(json.padEnd(Math.ceil(json.length / 4) * 4));
  const binary = points.byteLength + index.byteLength;
  const head = (...numbers: number[]): Uint32Array<ArrayBuffer> => Uint32Array.from(numbers);
  return new Blob([
    head(0x46546c67, 2, 12 + 8 + text.length + 8 + binary), head(text.length, 0x4e4f534a), text,
    head(binary, 0x004e4942), points as Float32Array<ArrayBuffer>, index as Uint32Array<ArrayBuffer>,
  ], { type: "model/gltf-binary" });
}

export function buildSaving(app: App, notice: (text: string) => void): { picture(): void } {
  const base = (app.metadata.title || "surface").replace(/[^\p{L}\p{N}._-]+/gu, "_").slice(0, 60);
  const here = (): string => app.positionText(app.axis, app.toPosition(app.state.offset)).replace(/[^\p{L}\p{N}.-]+/gu, "_");
  const caption = (): string => app.positionText(app.axis, app.toPosition(app.state.offset));
  const png = (canvas: HTMLCanvasElement): Promise<Blob> =>
    new Promise((resolve, reject) => canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("no picture"))), "image/png"));

  const picture = async (): Promise<void> => download(`${base}_${here()}.png`, await png(app.view.picture(caption())));
  const slice = (suffix: string, write: (positions: Float32Array) => Blob): void => {
    const triangles = app.slice();
    if (triangles.count === 0) return notice("There is nothing to save: the plane meets no part of the surface.");
    download(`${base}_${here()}.${suffix}`, write(coordinates(app, triangles)));
  };
  const frames = async (): Promise<void> => {
    const button = element<HTMLButtonElement>("save-frames");
    button.disabled = true;
    const before = app.state.offset;
    app.set({ playing: false });
    const files: { name: string; bytes: Uint8Array<ArrayBuffer> }[] = [];
    for (let i = 0; i < FRAMES; ++i) {
      notice(`Frame ${i + 1} of ${FRAMES}`);
      app.set({ offset: app.reach * ((2 * i) / (FRAMES - 1) - 1) });
      const blob = await png(app.view.picture(caption()));
      files.push({ name: `${base}_${String(i).padStart(3, "0")}.png`, bytes: new Uint8Array(await blob.arrayBuffer()) });
    }
    app.set({ offset: before });
    download(`${base}_frames.zip`, zip(files));
    notice(`${FRAMES} frames saved`);
    button.disabled = false;
  };

  element("save-png").addEventListener("click", () => void picture());
  element("save-frames").addEventListener("click", () => void frames());
  element("save-stl").addEventListener("click", () => slice("stl", stl));
  element("save-ply").addEventListener("click", () => slice("ply", ply));
  element("save-glb").addEventListener("click", () => slice("glb", glb));
  element("copy-link").addEventListener("click", () => {
    const link = app.link();
    history.replaceState(null, "", link);
    navigator.clipboard?.writeText(link).then(() => notice("Link copied"), () => notice("The link is in the address bar"));
  });
  return { picture: () => void picture() };
}

function withoutCollapsed({ count, positions: p, normals }: Triangles): Pick<Triangles, "count" | "positions" | "normals"> {
  const same = (a: number, b: number) => p[a] === p[b] && p[a + 1] === p[b + 1] && p[a + 2] === p[b + 2];
  const kept = Array.from({ length: count }, (_, i) => 9 * i)
    .filter((at) => !same(at, at + 3) && !same(at + 3, at + 6) && !same(at, at + 6));
  const gathered = (from: Float32Array): Float32Array => {
    const result = new Float32Array(9 * kept.length);
    kept.forEach((at, i) => result.set(from.subarray(at, at + 9), 9 * i));
    return result;
  };
  return { count: kept.length, positions: gathered(p), normals: gathered(normals) };
}
