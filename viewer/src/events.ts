// What is said of events.
import type { App } from "./app";
import type { TrackEvent } from "./metadata";

/// Events that leave the number of components as it is: there can be many.
export const isMinor = (type: string): boolean => type === "genus" || type === "touch";

const MEANINGS: Record<string, string> = {
  compound: "several begin, end or meet at once",
  genus: "a handle or a hole more or less",
  touch: "a wall begins or ends to cut it",
  enter: "through a wall",
  exit: "through a wall",
};
/// What the name of an event does not say, or nothing.
export const meaningOf = (type: string): string => MEANINGS[type] ?? "";

/// "genus at t = 0.5 s: a handle or a hole more or less"
export const eventText = (app: App, event: TrackEvent): string =>
  `${event.type} at ${app.positionText(app.space.timeAxis, event.time)}${meaningOf(event.type) && ": " + meaningOf(event.type)}`;
