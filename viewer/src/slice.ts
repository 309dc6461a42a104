// Cuts the surface on the CPU, exactly as the vertex shader does: for picking, for saving, for tests.
import { dot, type Frame, type LevelPlane, levelPlane, reachOf } from "./frame";
import { CHUNK, type Mesh } from "./mesh";
import type { Space } from "./space";

// For each pattern of corners beyond the plane (bit i: corner i), the cut edges in the order of a ring: four
// bits each, two for either end, the first edge lowest. A triangle repeats its last edge.
export const CUT_EDGES: readonly number[] = Array.from({ length: 16 }, (_, pattern) => {
  const corners = [0, 1, 2, 3];
  const beyond = corners.filter((i) => (pattern >> i) & 1);
  const before = corners.filter((i) => !((pattern >> i) & 1));
  if (beyond.length === 0 || before.length === 0) return 0;
  let edges: number[][];
  if (beyond.length === 2) {
    const [a, b] = beyond, [c, d] = before;
    edges = [[a!, c!], [a!, d!], [b!, d!], [b!, c!]];
  } else {
    const alone = beyond.length === 1 ? beyond[0]! : before[0]!;
    edges = corners.filter((i) => i !== alone).map((i) => [alone, i]);
    edges.push(edges[2]!);
  }
  return edges.reduce((packed, [a, b], i) => packed | (((a! << 2) | b!) << (4 * i)), 0);
});

/// The chunks that a plane meets, written to `chunks`; returns how many.
export function cutChunks(mesh: Mesh, plane: LevelPlane, chunks: Uint32Array): number {
  const count = mesh.boxes.length / 8;
  const [nx, ny, nz, nw] = plane.normal;
  let found = 0;
  for (let chunk = 0, at = 0; chunk < count; ++chunk, at += 8) {
    const b = mesh.boxes;
    const middle = nx * (b[at]! + b[at + 4]!) + ny * (b[at + 1]! + b[at + 5]!) +
      nz * (b[at + 2]! + b[at + 6]!) + nw * (b[at + 3]! + b[at + 7]!);
    const reach = Math.abs(nx) * (b[at + 4]! - b[at]!) + Math.abs(ny) * (b[at + 5]! - b[at + 1]!) +
      Math.abs(nz) * (b[at + 6]! - b[at + 2]!) + Math.abs(nw) * (b[at + 7]! - b[at + 3]!);
    if (Math.abs(middle - 2 * plane.offset) <= reach) chunks[found++] = chunk;
  }
  return found;
}

/// Triangles of the picture.
export interface Triangles {
  count: number;
  positions: Float32Array; // 9 per triangle, in the picture
  normals: Float32Array; // 9 per triangle, not of unit length
  points: Float32Array; // 12 per triangle: the scene positions of its corners
  simplices: Uint32Array; // 1 per triangle: the simplex it is cut from
}

class TriangleList {
  count = 0;
  private capacity = 1024;
  positions = new Float32Array(9 * 1024);
  normals = new Float32Array(9 * 1024);
  points = new Float32Array(12 * 1024);
  simplices = new Uint32Array(1024);

  grow(): void {
    const grown = <T extends Float32Array | Uint32Array>(old: T, size: number): T => {
      const result = new (old.constructor as { new (n: number): T })(size);
      result.set(old as never);
      return result;
    };
    this.capacity *= 2;
    this.positions = grown(this.positions, 9 * this.capacity);
    this.normals = grown(this.normals, 9 * this.capacity);
    this.points = grown(this.points, 12 * this.capacity);
    this.simplices = grown(this.simplices, this.capacity);
  }
  begin(simplex: number): void {
    if (this.count === this.capacity) this.grow();
    this.simplices[this.count] = simplex;
  }
  corner(i: number, frame: Frame, point: ArrayLike<number>, normal: ArrayLike<number>): void {
    for (let row = 0; row < 3; ++row) {
      this.positions[9 * this.count + 3 * i + row] = dot4(frame[row]!, point);
      this.normals[9 * this.count + 3 * i + row] = dot4(frame[row]!, normal);
    }
    for (let k = 0; k < 4; ++k) this.points[12 * this.count + 4 * i + k] = point[k]!;
  }
}

const dot4 = (a: ArrayLike<number>, b: ArrayLike<number>): number =>
  a[0]! * b[0]! + a[1]! * b[1]! + a[2]! * b[2]! + a[3]! * b[3]!;

/// The cut of the surface by the frame's hyperplane; in R^3, the surface itself.
export function cut(mesh: Mesh, space: Space, frame: Frame, offset: number): Triangles {
  const list = new TriangleList();
  const chunkCount = mesh.boxes.length / 8;
  const chunks = new Uint32Array(chunkCount);
  const plane = levelPlane(space, frame, offset);
  const found = mesh.corners === 3 ? chunkCount : cutChunks(mesh, plane, chunks);
  if (mesh.corners === 3) chunks.forEach((_, i) => (chunks[i] = i));
  const distance = new Float64Array(4);
  const point = [0, 0, 0, 0].map(() => new Float64Array(4));
  const normal = [0, 0, 0, 0].map(() => new Float64Array(4));

  const vertexAt = (vertex: number, i: number): void => {
    for (let k = 0; k < 4; ++k) {
      point[i]![k] = mesh.levels[4 * vertex + k]! * space.scale[k]! + space.shift[k]!;
      normal[i]![k] = mesh.normals[4 * vertex + k]!;
    }
  };
  // From the vertex of the lower number, so that all simplices at an edge find the same point, to the bit.
  const between = (one: number, other: number, i: number): void => {
    const [a, b] = corner[one]! < corner[other]! ? [one, other] : [other, one];
    const share = distance[a]! / (distance[a]! - distance[b]!);
    for (let k = 0; k < 4; ++k) {
      const p = mesh.levels[corner[a]! + k]!, q = mesh.levels[corner[b]! + k]!;
      point[i]![k] = (p + share * (q - p)) * space.scale[k]! + space.shift[k]!;
      const m = mesh.normals[corner[a]! + k]!, n = mesh.normals[corner[b]! + k]!;
      normal[i]![k] = m + share * (n - m);
    }
  };
  const triangle = (simplex: number, a: number, b: number, c: number): void => {
    list.begin(simplex);
    [a, b, c].forEach((from, i) => list.corner(i, frame, point[from]!, normal[from]!));
    ++list.count;
  };
  const corner = new Uint32Array(4);

  for (let i = 0; i < found; ++i) {
    const end = Math.min((chunks[i]! + 1) * CHUNK, mesh.simplexCount);
    for (let simplex = chunks[i]! * CHUNK; simplex < end; ++simplex) {
      if (mesh.corners === 3) {
        for (let j = 0; j < 3; ++j) vertexAt(mesh.simplices[4 * simplex + j]!, j);
        triangle(simplex, 0, 1, 2);
        continue;
      }
      let pattern = 0;
      for (let j = 0; j < 4; ++j) {
        corner[j] = 4 * mesh.simplices[4 * simplex + j]!;
        distance[j] = dot4(plane.normal, mesh.levels.subarray(corner[j]!, corner[j]! + 4)) - plane.offset;
        if (distance[j]! >= 0) pattern |= 1 << j;
      }
      if (pattern === 0 || pattern === 15) continue;
      for (let j = 0; j < 4; ++j) {
        const edge = (CUT_EDGES[pattern]! >> (4 * j)) & 15;
        between(edge >> 2, edge & 3, j);
      }
      triangle(simplex, 0, 1, 2);
      if (((CUT_EDGES[pattern]! >> 8) & 15) !== ((CUT_EDGES[pattern]! >> 12) & 15)) triangle(simplex, 0, 2, 3);
    }
  }
  return list;
}

/// The edges of the domain's box that the hyperplane shows: pairs of points of the picture.
export function outline(space: Space, frame: Frame, offset: number): number[] {
  const segments: number[] = [];
  const dimension = space.dimension;
  const axes = [...Array(dimension).keys()];
  const corner = (bits: number) => [0, 1, 2, 3].map((k) => ((bits >> k) & 1 ? 1 : -1) * space.half[k]!);
  const picture = (p: number[]) => [0, 1, 2].map((row) => dot(frame[row]!, p));
  if (dimension === 3) {
    for (const k of axes)
      for (let bits = 0; bits < 8; ++bits)
        if (!((bits >> k) & 1)) segments.push(...picture(corner(bits)), ...picture(corner(bits | (1 << k))));
    return segments;
  }
  // A plane at the very end of the domain shows that end.
  const inside = Math.max(-1, Math.min(1, offset / reachOf(space, frame))) * reachOf(space, frame) * (1 - 1e-9);
  for (const i of axes)
    for (const j of axes.filter((other) => other > i))
      for (let bits = 0; bits < 16; ++bits) {
        if ((bits >> i) & 1 || (bits >> j) & 1) continue;
        const ring = [bits, bits | (1 << i), bits | (1 << i) | (1 << j), bits | (1 << j)].map(corner);
        const crossings: number[][] = [];
        ring.forEach((a, at) => {
          const b = ring[(at + 1) % 4]!;
          const da = dot(frame[3], a) - inside, db = dot(frame[3], b) - inside;
          if (da >= 0 === db >= 0) return;
          crossings.push(a.map((x, k) => x + (da / (da - db)) * (b[k]! - x)));
        });
        if (crossings.length === 2) segments.push(...picture(crossings[0]!), ...picture(crossings[1]!));
      }
  return segments;
}



