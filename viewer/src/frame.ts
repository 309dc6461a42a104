// A hyperplane of the scene with directions in it. Rows of four numbers: three directions E that become x, y
// and z of the picture, and the normal N. In R^3 the picture is the space itself and only N is used.
import type { Space, Vector4 } from "./space";

export type Frame = readonly [Vector4, Vector4, Vector4, Vector4];

const unitVector = (k: number): Vector4 => [0, 1, 2, 3].map((i) => (i === k ? 1 : 0)) as Vector4;
export const dot = (a: readonly number[], b: readonly number[]): number =>
  a.reduce((sum, x, k) => sum + x * (b[k] ?? 0), 0);

/// Across axis `k`: the picture shows the others in their order.
export function axisFrame(space: Space, k: number): Frame {
  const others = [0, 1, 2, 3].filter((i) => i !== k);
  if (space.dimension === 3) return [unitVector(0), unitVector(1), unitVector(2), unitVector(k)];
  return [unitVector(others[0]!), unitVector(others[1]!), unitVector(others[2]!), unitVector(k)];
}

/// The axis that the frame's normal runs along; -1 for an oblique one.
export function axisOf(frame: Frame): number {
  return frame[3].findIndex((x) => Math.abs(Math.abs(x) - 1) < 1e-6);
}

/// The same frame turned by the smallest rotation that takes its normal to `normal` (not 0).
export function turnedTo(space: Space, frame: Frame, normal: Vector4): Frame {
  const length = Math.hypot(...normal);
  const target = normal.map((x) => x / length) as Vector4;
  if (space.dimension === 3) return [frame[0], frame[1], frame[2], target];
  const old = frame[3];
  const cosine = dot(old, target);
  if (cosine < -1 + 1e-9) return [frame[0].map((x) => -x) as Vector4, frame[1], frame[2], target];
  const turn = (e: Vector4): Vector4 => {
    const factor = dot(e, target) / (1 + cosine);
    return e.map((x, k) => x - factor * (old[k]! + target[k]!)) as Vector4;
  };
  return orthonormal([turn(frame[0]), turn(frame[1]), turn(frame[2]), target]);
}

/// The same frame turned by `angle` in the plane of two axes, from `i` to `j`.
export function rotated(frame: Frame, i: number, j: number, angle: number): Frame {
  const cosine = Math.cos(angle), sine = Math.sin(angle);
  return orthonormal(frame.map((row) => {
    const result = [...row] as Vector4;
    result[i] = cosine * row[i]! - sine * row[j]!;
    result[j] = sine * row[i]! + cosine * row[j]!;
    return result;
  }) as unknown as Frame);
}

/// Rounding errors of many small turns do not add up.
export function orthonormal(frame: Frame): Frame {
  const rows: Vector4[] = [];
  for (const row of [frame[3], frame[0], frame[1], frame[2]]) {
    const result = [...row] as Vector4;
    for (const done of rows) {
      const share = dot(result, done);
      for (let k = 0; k < 4; ++k) result[k]! -= share * done[k]!;
    }
    const length = Math.hypot(...result);
    rows.push(result.map((x) => x / length) as Vector4);
  }
  return [rows[1]!, rows[2]!, rows[3]!, rows[0]!];
}

/// How far the plane can go before it leaves the domain: offsets lie in -reach..reach.
export function reachOf(space: Space, frame: Frame): number {
  return frame[3].reduce((sum, x, k) => sum + Math.abs(x) * space.half[k]!, 0);
}

/// The plane in levels, as what is cut is stored: normal . level = offset. A plane across an axis gets a
/// normal of 1, so that steps, which lie on whole levels, are met exactly. A vertex on the plane counts as
/// beyond it, so a plane at the very beginning would cut nothing: it starts a little later.
export interface LevelPlane {
  normal: Vector4;
  offset: number;
}

export function levelPlane(space: Space, frame: Frame, offset: number): LevelPlane {
  const normal = frame[3].map((x, k) => x * space.scale[k]!) as Vector4;
  const level = offset - dot(frame[3], space.shift);
  const axis = axisOf(frame);
  if (axis < 0) return { normal, offset: level };
  const quarter = 0.25;
  const first = (space.axes[axis]!.minimum - space.axes[axis]!.origin) / space.axes[axis]!.scale;
  const exact = level / normal[axis]!;
  const whole = Math.abs(exact - Math.round(exact)) < 1e-3 ? Math.round(exact) : exact;
  return { normal: unitVector(axis), offset: Math.max(whole, first + quarter) };
}
