// What is said of events.
import type { App } from "./app";
import type { TrackEvent } from "./metadata";

/// Events that leave the number of components as it is: there can be many.
export const isMinor = (type: string): boolean => type === "genus" || type === "touch";

/// The types in the order in which they are listed, and what each of them means.
export const EVENT_TYPES: Record<string, string> = {
  merge: "two or more components meet and go on as one",
  split: "a component parts",
  compound: "several begin, end or meet at once",
  birth: "a component begins",
  death: "a component ends",
  enter: "a component comes in through a wall",
  exit: "a component goes out through a wall",
  genus: "a handle or a hole more or less",
  touch: "a wall begins or ends to cut a component",
};

const FINER = 100; // times of events, than those of other moments

function named(tracks: readonly number[]): string {
  if (tracks.length === 0) return "nothing";
  return `${tracks.length === 1 ? "track" : "tracks"} ${tracks.join(", ")}`;
}

/// Of a component cut by walls in curves, the rims, the Euler characteristic is 2 - 2 handles - rims; a touch leaves the
/// handles as they are.
function changeOfTopology(app: App, { type, delta_euler: change = 0 }: TrackEvent): string {
  const more = change < 0 ? "more" : "less", count = Math.abs(change);
  if (app.metadata.tracking!.regions) return bodyText(app, change);
  if (type === "genus") return change ? `a handle or a hole ${more}` : "its genus changes";
  if (app.space.dimension < 4 || !change) return "a wall begins or ends to cut it";
  return `walls cut it in ${count === 1 ? "one curve" : `${count} curves`} ${more}`;
}

/// Of a body in space the Euler characteristic is 1 - tunnels + cavities, of one in a plane 1 - holes.
function bodyText(app: App, change: number): string {
  if (app.space.dimension < 4) return `a hole ${change < 0 ? "more" : "less"}`;
  return change < 0 ? "a tunnel more or a cavity less" : "a tunnel less or a cavity more";
}

/// What happens, to those tracks that are shown: "tracks 0, 3 → track 0".
function happening(app: App, event: TrackEvent): string {
  const [from, to] = [event.in, event.out].map((ids) => ids.filter((id) => !app.isSimplified(id)).sort((a, b) => a - b)) as [number[], number[]];
  const one = named(to.length ? to : from);
  switch (event.type) {
    case "birth": return `${one} begins`;
    case "death": return `${one} ends`;
    case "enter": return `${one} comes in through a wall`;
    case "exit": return `${one} goes out through a wall`;
    case "genus":
    case "touch": return `${one}: ${changeOfTopology(app, event)}`;
    default: return `${named(from)} → ${named(to)}`;
  }
}

export const eventLines = (app: App, event: TrackEvent): string[] =>
  [event.type, happening(app, event), app.positionText(app.space.timeAxis, event.time, FINER)];

/// "split at t = 0.50012 s: track 0 → 0, 3"
export function eventText(app: App, event: TrackEvent): string {
  const [type, what, time] = eventLines(app, event);
  return `${type} at ${time}: ${what}`;
}
