// The surface as arrays, and how a payload becomes one. Nothing here knows where the payload came from.
import type { Metadata } from "./metadata";
import type { Space } from "./space";

export const CHUNK = 256; // simplices

export interface Mesh {
  corners: 3 | 4; // of a simplex: triangles in R^3, tetrahedra in R^4
  vertexCount: number;
  simplexCount: number;
  levels: Uint16Array; // 4 per vertex; the last is 0 in R^3
  simplices: Uint32Array; // 4 per simplex; in R^3 the last repeats
  normals: Int8Array; // 4 per vertex, from + to -, of length 127
  boxes: Float32Array; // 8 per chunk: lowest and highest levels
  attributes: Uint16Array[]; // one number per vertex
}

/// Takes blocks one after the other, in the order of the metadata.
export class MeshReader {
  private readonly levels: Uint16Array;
  private readonly simplices: Uint32Array;
  private readonly attributes: Uint16Array[];
  private block = 0;
  private vertex = 0;
  private simplex = 0;

  constructor(private readonly metadata: Metadata) {
    this.levels = new Uint16Array(4 * metadata.vertices);
    this.simplices = new Uint32Array(4 * metadata.simplices);
    this.attributes = metadata.attributes.map(() => new Uint16Array(metadata.vertices));
  }

  add(bytes: Uint8Array): void {
    const { vertices, simplices } = this.metadata.blocks![this.block]!;
    const { dimension, attributes } = this.metadata;
    const corners = this.metadata.simplexDimension + 1;
    const expected = 2 * vertices * (dimension + attributes.length) + 3 * corners * simplices;
    if (bytes.length !== expected)
      throw new Error(`part ${this.block + 1} of the data has ${bytes.length} bytes instead of ${expected}`);
    let at = 0;
    for (let axis = 0; axis < dimension; ++axis, at += 2 * vertices)
      readSteps(bytes, at, vertices, this.levels, 4 * this.vertex + axis, 4);
    for (const attribute of this.attributes) {
      readSteps(bytes, at, vertices, attribute, this.vertex, 1);
      at += 2 * vertices;
    }
    this.readCorners(bytes, at, corners * simplices, corners);
    this.simplex += simplices;
    ++this.block;
  }

  private readCorners(bytes: Uint8Array, low: number, codes: number, corners: number): void {
    const middle = low + codes;
    const high = middle + codes;
    for (let i = 0; i < codes; ++i) {
      const code = bytes[low + i]! | (bytes[middle + i]! << 8) | (bytes[high + i]! << 16);
      const vertex = this.vertex - code;
      if (code === 0) ++this.vertex;
      if (vertex < 0 || vertex >= this.metadata.vertices)
        throw new Error(`part ${this.block + 1} of the data names a vertex that does not exist`);
      const simplex = this.simplex + Math.floor(i / corners);
      this.simplices[4 * simplex + (i % corners)] = vertex;
      if (i % corners === corners - 1) this.simplices[4 * simplex + 3] = vertex;
    }
  }

  finish(space: Space): Mesh {
    if (this.block !== this.metadata.blocks!.length) throw new Error("a part of the data is missing");
    const mesh = {
      corners: (this.metadata.simplexDimension + 1) as 3 | 4,
      vertexCount: this.metadata.vertices,
      simplexCount: this.metadata.simplices,
      levels: this.levels,
      simplices: this.simplices,
      attributes: this.attributes,
    };
    return { ...mesh, boxes: boxesOf(mesh), normals: normalsOf(mesh, space) };
  }
}

function readSteps(
  bytes: Uint8Array, low: number, count: number, into: Uint16Array, first: number, stride: number,
): void {
  let level = 0;
  for (let i = 0; i < count; ++i) {
    const zigzag = bytes[low + i]! | (bytes[low + count + i]! << 8);
    level = (level + ((zigzag >>> 1) ^ -(zigzag & 1))) & 0xffff;
    into[first + i * stride] = level;
  }
}

/// The attributes of all vertices, from a part of their own.
export function readAttributes(bytes: Uint8Array, count: number, vertices: number): Uint16Array[] {
  if (bytes.length !== 2 * vertices * count) throw new Error("the attributes are damaged");
  return Array.from({ length: count }, (_, k) => {
    const values = new Uint16Array(vertices);
    readSteps(bytes, 2 * vertices * k, vertices, values, 0, 1);
    return values;
  });
}

type Shape = Pick<Mesh, "corners" | "vertexCount" | "simplexCount" | "levels" | "simplices">;

export function boxesOf(mesh: Shape): Float32Array {
  const chunks = Math.ceil(mesh.simplexCount / CHUNK);
  const boxes = new Float32Array(8 * chunks);
  for (let chunk = 0; chunk < chunks; ++chunk) {
    const end = 4 * Math.min((chunk + 1) * CHUNK, mesh.simplexCount);
    const box = boxes.subarray(8 * chunk, 8 * chunk + 8);
    box.fill(65535, 0, 4);
    for (let i = 4 * chunk * CHUNK; i < end; ++i) {
      const vertex = 4 * mesh.simplices[i]!;
      for (let axis = 0; axis < 4; ++axis) {
        const level = mesh.levels[vertex + axis]!;
        if (level < box[axis]!) box[axis] = level;
        if (level > box[4 + axis]!) box[4 + axis] = level;
      }
    }
  }
  return boxes;
}

/// Normals in scene coordinates: of each vertex the sum of those of its simplices, weighted by content.
export function normalsOf(mesh: Shape, space: Space): Int8Array {
  const sums = new Float32Array(4 * mesh.vertexCount);
  const [sx, sy, sz, sw] = space.scale as [number, number, number, number];
  const { levels, simplices } = mesh;
  for (let simplex = 0; simplex < 4 * mesh.simplexCount; simplex += 4) {
    const a = 4 * simplices[simplex]!, b = 4 * simplices[simplex + 1]!;
    const c = 4 * simplices[simplex + 2]!, d = 4 * simplices[simplex + 3]!;
    const ax = levels[a]!, ay = levels[a + 1]!, az = levels[a + 2]!, aw = levels[a + 3]!;
    const ux = (levels[b]! - ax) * sx, uy = (levels[b + 1]! - ay) * sy;
    const uz = (levels[b + 2]! - az) * sz, uw = (levels[b + 3]! - aw) * sw;
    const vx = (levels[c]! - ax) * sx, vy = (levels[c + 1]! - ay) * sy;
    const vz = (levels[c + 2]! - az) * sz, vw = (levels[c + 3]! - aw) * sw;
    // In R^3 the third edge is that of a fourth axis, so that one formula serves both; its sign is that of
    // det[n; u; v], which stands in the first three rows and columns.
    const flat = mesh.corners === 3;
    const wx = flat ? 0 : (levels[d]! - ax) * sx, wy = flat ? 0 : (levels[d + 1]! - ay) * sy;
    const wz = flat ? 0 : (levels[d + 2]! - az) * sz, ww = flat ? 1 : (levels[d + 3]! - aw) * sw;
    const xy = vx * wy - vy * wx, xz = vx * wz - vz * wx, xw = vx * ww - vw * wx;
    const yz = vy * wz - vz * wy, yw = vy * ww - vw * wy, zw = vz * ww - vw * wz;
    const nx = uy * zw - uz * yw + uw * yz;
    const ny = -(ux * zw - uz * xw + uw * xz);
    const nz = ux * yw - uy * xw + uw * xy;
    const nw = -(ux * yz - uy * xz + uz * xy);
    for (let corner = 0; corner < mesh.corners; ++corner) {
      const at = 4 * simplices[simplex + corner]!;
      sums[at] += nx;
      sums[at + 1] += ny;
      sums[at + 2] += nz;
      sums[at + 3] += nw;
    }
  }
  const normals = new Int8Array(sums.length);
  for (let at = 0; at < sums.length; at += 4) {
    const length = Math.hypot(sums[at]!, sums[at + 1]!, sums[at + 2]!, sums[at + 3]!) || 1;
    for (let axis = 0; axis < 4; ++axis) normals[at + axis] = Math.round((127 * sums[at + axis]!) / length);
  }
  return normals;
}

/// Connected components, numbered from the one with most simplices: of each vertex, its component.
export function componentsOf(mesh: Mesh): { count: number; ofVertex: Uint32Array } {
  const parent = new Uint32Array(mesh.vertexCount).map((_, i) => i);
  const find = (vertex: number): number => {
    while (parent[vertex] !== vertex) vertex = parent[vertex] = parent[parent[vertex]!]!;
    return vertex;
  };
  for (let i = 0; i < mesh.simplices.length; i += 4) {
    const root = find(mesh.simplices[i]!);
    for (let corner = 1; corner < mesh.corners; ++corner) {
      const other = find(mesh.simplices[i + corner]!);
      if (other !== root) parent[other] = root;
    }
  }
  const sizes = new Map<number, number>();
  for (let i = 0; i < mesh.simplices.length; i += 4) {
    const root = find(mesh.simplices[i]!);
    sizes.set(root, (sizes.get(root) ?? 0) + 1);
  }
  const order = [...sizes].sort((a, b) => b[1] - a[1] || a[0] - b[0]);
  const number = new Map(order.map(([root], i) => [root, i]));
  const ofVertex = new Uint32Array(mesh.vertexCount);
  for (let vertex = 0; vertex < mesh.vertexCount; ++vertex) ofVertex[vertex] = number.get(find(vertex)) ?? 0;
  return { count: order.length, ofVertex };
}
