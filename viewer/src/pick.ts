// Reads the point of the surface under the pointer.
import { Raycaster, Vector2, Vector3 } from "three";
import { type App, element, NO_TRACK } from "./app";
import { readable } from "./space";
import type { Triangles } from "./slice";

interface Hit {
  distance: number;
  triangle: number;
  weights: [number, number, number];
}

export function pick(app: App, x: number, y: number): (Hit & { triangles: Triangles; point: Vector3 }) | null {
  const stage = element("stage");
  const caster = new Raycaster();
  caster.setFromCamera(new Vector2((2 * x) / stage.clientWidth - 1, 1 - (2 * y) / stage.clientHeight), app.view.camera);
  const { origin, direction } = caster.ray;
  const triangles = app.slice();
  const p = triangles.positions;
  let best: Hit | null = null;
  const a = new Vector3(), u = new Vector3(), v = new Vector3(), h = new Vector3(), s = new Vector3(), q = new Vector3();
  const place = new Vector3();
  const { clip, boxLow, boxHigh } = app.surface.uniforms;
  for (let triangle = 0; triangle < triangles.count; ++triangle) {
    const at = 9 * triangle;
    a.fromArray(p, at);
    u.fromArray(p, at + 3).sub(a);
    v.fromArray(p, at + 6).sub(a);
    h.crossVectors(direction, v);
    const determinant = u.dot(h);
    if (determinant === 0) continue;
    s.subVectors(origin, a);
    const second = s.dot(h) / determinant;
    if (second < 0 || second > 1) continue;
    q.crossVectors(s, u);
    const third = direction.dot(q) / determinant;
    if (third < 0 || second + third > 1) continue;
    const distance = v.dot(q) / determinant;
    if (distance <= (app.view.camera === app.view.orthographic ? -1e9 : 0) || (best && distance >= best.distance)) continue;
    place.copy(direction).multiplyScalar(distance).add(origin);
    const clipped = place.x * clip.value.x + place.y * clip.value.y + place.z * clip.value.z > clip.value.w ||
      [0, 1, 2].some((k) => place.getComponent(k) < boxLow.value.getComponent(k) || place.getComponent(k) > boxHigh.value.getComponent(k));
    if (!clipped) best = { distance, triangle, weights: [1 - second - third, second, third] };
  }
  if (!best) return null;
  const hit: Hit = best;
  return { ...hit, triangles, point: origin.clone().addScaledVector(direction, hit.distance) };
}

/// What there is to say about a point of the surface.
function describe(app: App, hit: NonNullable<ReturnType<typeof pick>>): string[] {
  const lines = app.space.axes.map((axis, k) => {
    const scene = hit.weights.reduce((sum, weight, i) => sum + weight * hit.triangles.points[12 * hit.triangle + 4 * i + k]!, 0);
    const step = (axis.maximum - axis.minimum) / 1000;
    return `${axis.name} = ${readable(app.space.coordinate(k, scene), step)} ${axis.unit}`.trim();
  });
  const vertex = app.mesh.simplices[4 * hit.triangles.simplices[hit.triangle]!]!;
  const track = app.trackOfVertex()?.[vertex];
  if (track === NO_TRACK) lines.push("no track: it begins and ends between two steps");
  else if (track !== undefined) lines.push(`track ${track}`);
  else lines.push(`component ${app.componentOfVertex()[vertex]! + 1} of ${app.componentCount()}`);
  if (app.isOwnSurface) app.metadata.attributes.forEach((attribute, k) => {
    const level = app.mesh.attributes[k]![vertex]!;
    if (attribute.kind === "scalar") {
      const range = attribute.maximum - attribute.minimum;
      lines.push(`${attribute.name} = ${readable(attribute.minimum + (level / 65535) * range, range / 1000)}`);
    } else if (k !== app.trackAttribute()) {
      lines.push(`${attribute.name} = ${attribute.labels[level]}`);
    }
  });
  if (app.metadata.isovalue !== undefined) lines.push(`${app.metadata.field || "value"} = ${app.shownIsovalue}`);
  return lines;
}

export function buildPicking(app: App): void {
  const canvas = element("view");
  let down: { x: number; y: number } | null = null;
  canvas.addEventListener("pointerdown", (event) => (down = { x: event.offsetX, y: event.offsetY }));
  canvas.addEventListener("pointerup", (event) => {
    const still = down && Math.hypot(event.offsetX - down.x, event.offsetY - down.y) < 5;
    down = null;
    if (!still || event.button !== 0) return;
    const hit = pick(app, event.offsetX, event.offsetY);
    app.view.marker = null;
    if (hit) app.mark(hit.point, describe(app, hit));
    const track = hit && app.trackOfVertex()?.[app.mesh.simplices[4 * hit.triangles.simplices[hit.triangle]!]!];
    if (app.colouring.key === "track") app.set({ highlight: track === NO_TRACK ? -1 : track ?? -1 });
    app.view.request();
  });
}
