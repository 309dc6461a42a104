// Everything that a reader can change, and its form in the address of the page.
import { axisFrame, axisOf, type Frame, orthonormal, reachOf } from "./frame";
import type { Metadata } from "./metadata";
import type { Space, Vector4 } from "./space";

export interface State {
  frame: Frame;
  offset: number; // of the plane along the frame's normal
  playing: boolean;
  speed: number;
  loop: "repeat" | "bounce" | "once";
  colour: string; // "solid", "time", "speed", "component", "track", "axis:K" or "attribute:K"
  map: string;
  reversed: boolean;
  range: [number, number] | null; // null: of all data
  opacity: number;
  wireframe: boolean;
  axes: boolean;
  clipAxis: number; // -1: no clip plane, else an axis of the picture
  clipAt: number; // 0..1 along it
  clipFlip: boolean;
  box: number[]; // 0..1: low and high along each axis of the picture
  hideBeyond: boolean; // surfaces in R^3: what lies beyond the plane
  projection: "perspective" | "orthographic";
  theme: "auto" | "light" | "dark";
  camera: number[] | null; // position and target; null: as at first
  highlight: number; // a track; -1: none
  hide: string; // types of events, with commas between them
  isovalue: number; // asked for; the page's own, where it holds no field
}

export function initialState(metadata: Metadata, space: Space): State {
  const frame = axisFrame(space, space.dimension - 1);
  const time = space.timeAxis >= 0;
  return {
    frame,
    offset: time ? -reachOf(space, frame) : space.dimension === 3 ? reachOf(space, frame) : 0,
    playing: false,
    speed: 1,
    loop: "repeat",
    colour: initialColour(metadata),
    map: metadata.colourBy === "speed" ? "blue to red" : "viridis",
    reversed: false,
    range: null,
    opacity: 1,
    wireframe: false,
    axes: true,
    clipAxis: -1,
    clipAt: 0.5,
    clipFlip: false,
    box: [0, 1, 0, 1, 0, 1],
    hideBeyond: false,
    projection: "perspective",
    theme: "auto",
    camera: null,
    highlight: -1,
    hide: "",
    isovalue: metadata.isovalue ?? 0,
  };
}

function initialColour(metadata: Metadata): string {
  const wanted = metadata.colourBy;
  if (wanted === "" || wanted === "solid") return metadata.tracking && wanted === "" ? "track" : "solid";
  const attribute = metadata.attributes.findIndex((one) => one.name === wanted);
  if (attribute >= 0) return `attribute:${attribute}`;
  const axis = metadata.axes.findIndex((one) => one.name === wanted);
  if (axis >= 0) return `axis:${axis}`;
  return wanted;
}

const short = (x: number): string => String(Number(x.toPrecision(6)));

/// The part of the address after #: what differs from the state at first.
export function toHash(state: State, initial: State, space: Space): string {
  const parts: string[] = [];
  const axis = axisOf(state.frame);
  const sameFrame = state.frame.flat().every((x, i) => Math.abs(x - initial.frame.flat()[i]!) < 1e-6);
  if (!sameFrame) parts.push(`plane=${state.frame.flat().map(short).join(",")}`);
  if (state.offset !== initial.offset)
    parts.push(axis >= 0 && sameFrame ? `at=${short(space.coordinate(axis, state.offset))}` : `offset=${short(state.offset)}`);
  for (const key of Object.keys(initial) as (keyof State)[]) {
    if (key === "frame" || key === "offset" || key === "playing" || key === "highlight") continue;
    const value = state[key];
    if (JSON.stringify(value) === JSON.stringify(initial[key])) continue;
    parts.push(`${key}=${encodeURIComponent(Array.isArray(value) ? value.map(short).join(",") : String(value))}`);
  }
  return parts.join("&");
}

/// Reads what `toHash` wrote; what it cannot read it leaves as it is.
export function fromHash(hash: string, initial: State, space: Space): State {
  const state = { ...initial };
  const given = new URLSearchParams(hash.replace(/^#/, ""));
  const numbers = (key: string, count: number): number[] | null => {
    const list = (given.get(key) || "?").split(",").map(Number);
    return list.length === count && list.every(Number.isFinite) ? list : null;
  };
  const plane = numbers("plane", 16);
  if (plane) {
    const row = (i: number) => plane.slice(4 * i, 4 * i + 4) as Vector4;
    const frame = orthonormal([row(0), row(1), row(2), row(3)]);
    if (frame.flat().every(Number.isFinite)) state.frame = frame;
  }
  const at = numbers("at", 1), offset = numbers("offset", 1);
  const axis = axisOf(state.frame);
  if (at && axis >= 0) state.offset = space.scene(axis, at[0]!);
  else if (offset) state.offset = offset[0]!;
  const reach = reachOf(space, state.frame);
  state.offset = Math.max(-reach, Math.min(reach, state.offset));

  const among = <T>(key: string, choices: readonly T[], use: (choice: T) => void): void => {
    const found = choices.find((choice) => String(choice) === given.get(key));
    if (found !== undefined) use(found);
  };
  among("loop", ["repeat", "bounce", "once"] as const, (x) => (state.loop = x));
  among("projection", ["perspective", "orthographic"] as const, (x) => (state.projection = x));
  among("theme", ["auto", "light", "dark"] as const, (x) => (state.theme = x));
  among("clipAxis", [-1, 0, 1, 2], (x) => (state.clipAxis = x));
  for (const key of ["reversed", "wireframe", "axes", "clipFlip", "hideBeyond"] as const)
    among(key, [true, false], (x) => (state[key] = x));
  for (const key of ["speed", "opacity", "clipAt", "isovalue"] as const) {
    const value = numbers(key, 1);
    if (value) state[key] = value[0]!;
  }
  if (given.has("colour")) state.colour = given.get("colour")!;
  if (given.has("map")) state.map = given.get("map")!;
  if (given.has("hide")) state.hide = given.get("hide")!;
  state.range = numbers("range", 2) as [number, number] | null;
  state.box = numbers("box", 6) ?? state.box;
  state.camera = numbers("camera", 6);
  return state;
}
