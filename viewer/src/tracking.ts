// The tracking graph under the scene: a lane for each track along the time line, a glyph for each event.
import { type App, element } from "./app";
import { labelColour } from "./colours";
import { EVENT_TYPES, eventText, isMinor } from "./events";
import type { Track, TrackEvent } from "./metadata";

const SVG = "http://www.w3.org/2000/svg";
const LANE = 20, TOP = 8;
const MOST_NAMED = 16; // events that are named beside their glyph
const GLYPH = 7, NAME = 11, LETTER = 6.5; // how far a glyph reaches, where its name begins; the width of a letter

/// A part of a lane that something takes up.
interface Extent {
  lane: number;
  low: number;
  high: number;
}
const meet = (a: Extent, b: Extent): boolean => a.lane === b.lane && a.low < b.high && b.low < a.high;
/// The first place from `begin` on where `width` is free.
function freePlace(begin: number, width: number, taken: readonly Extent[]): number {
  return [...taken].sort((a, b) => a.low - b.low).reduce((place, { low, high }) => (low < place + width && place < high ? high + 2 : place), begin);
}

function svg<K extends keyof SVGElementTagNameMap>(name: K, attributes: Record<string, string | number>): SVGElementTagNameMap[K] {
  const result = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) result.setAttribute(key, String(value));
  return result;
}

function titleOf(text: string): SVGTitleElement {
  const title = svg("title", {});
  title.textContent = text;
  return title;
}

/// Tracks in lanes: the next free lane near those it came from, so that links are short.
function lanesOf(tracks: readonly Track[]): Map<number, number> {
  const lanes: number[] = []; // when each lane is free again
  const result = new Map<number, number>();
  for (const track of [...tracks].sort((a, b) => a.start_time - b.start_time || a.id - b.id)) {
    const near = (track.parents ?? []).map((id) => result.get(id)).find((lane) => lane !== undefined) ?? 0;
    const free = lanes.map((end, lane) => ({ lane, end })).filter(({ end }) => end < track.start_time)
      .sort((a, b) => Math.abs(a.lane - near) - Math.abs(b.lane - near))[0];
    const lane = free?.lane ?? lanes.length;
    lanes[lane] = track.end_time;
    result.set(track.id, lane);
  }
  return result;
}

const GLYPHS: Record<string, string> = {
  merge: "M-5 -5 L5 0 L-5 5z",
  split: "M5 -5 L-5 0 L5 5z",
  compound: "M0 -6 L6 0 L0 6 L-6 0z",
};

function glyphOf(type: string): SVGElement {
  if (GLYPHS[type]) return svg("path", { d: GLYPHS[type]! });
  if (type === "genus") return svg("rect", { x: -2.5, y: -5, width: 5, height: 10, rx: 2.5 });
  if (type === "touch") return svg("rect", { x: -1, y: -5, width: 2, height: 10 });
  return svg("circle", { r: 4.5 });
}

const counted = (count: number, noun: string): string => `${count} ${noun}${count === 1 ? "" : "s"}`;
/// "8 of 28 tracks"
const share = (count: number, all: number, noun: string): string => (count === all ? "" : `${count} of `) + counted(all, noun);

/// A button for each type of event there is, with how many: whether they are shown.
function typeButtons(app: App): HTMLElement {
  const group = document.createElement("span");
  group.className = "event-types";
  group.setAttribute("role", "group");
  group.setAttribute("aria-label", "Events that are shown");
  for (const [type, meaning] of Object.entries(EVENT_TYPES)) {
    const count = app.allEvents.filter((event) => event.type === type).length;
    if (count === 0) continue;
    const button = document.createElement("button");
    Object.assign(button, { type: "button", title: `${type}: ${meaning}. Click to show or hide these events` });
    button.append(pictureOf(type), `${type} ${count}`);
    button.addEventListener("click", () => app.showType(type, app.hiddenTypes().includes(type)));
    const showPressed = (): void => button.setAttribute("aria-pressed", String(!app.hiddenTypes().includes(type)));
    showPressed();
    app.onChange((_, changed) => changed.has("hide") && showPressed());
    group.append(button);
  }
  return group;
}

/// The line above the lanes: what they are, which events are shown, and buttons from event to event.
function headOf(app: App, tracks: readonly Track[]): HTMLElement {
  const head = document.createElement("div");
  head.className = "tracking-head";
  const name = document.createElement("strong");
  const left = app.metadata.tracking!.tracks.length - tracks.length;
  name.title = "Point at a track to see it in the picture; click an event to go there" +
    (left ? `. ${counted(left, "track")} marked as small or short and what happens to them alone are left out here` : "");
  const showCount = (): void => {
    name.textContent = `${share(tracks.length, app.metadata.tracking!.tracks.length, "track")}${app.metadata.tracking!.regions ? " of regions" : ""}, ` +
      share(app.chosenEvents().length, app.allEvents.length, "event");
  };
  showCount();
  head.append(name);
  if (app.allEvents.length === 0) return head;
  const buttons = document.createElement("span");
  buttons.className = "event-buttons";
  for (const [direction, text, title] of [[-1, "‹ event", "Previous event ([)"], [1, "event ›", "Next event (])"]] as const) {
    const button = document.createElement("button");
    Object.assign(button, { type: "button", textContent: text, title, id: direction < 0 ? "event-back" : "event-forward" });
    button.setAttribute("aria-label", title.replace(/ \(.*/, ""));
    button.addEventListener("click", () => app.stepEvent(direction));
    app.onChange((_, changed) => changed.has("hide") && (button.disabled = app.chosenEvents().length === 0));
    buttons.append(button);
  }
  head.append(typeButtons(app), buttons);
  app.onChange((_, changed) => changed.has("hide") && showCount());
  return head;
}

function pictureOf(type: string): SVGElement {
  const drawing = svg("svg", { viewBox: "-8 -8 16 16", "aria-hidden": "true" });
  const glyph = svg("g", { class: isMinor(type) ? "glyph-sample minor" : "glyph-sample" });
  glyph.append(glyphOf(type));
  drawing.append(glyph);
  return drawing;
}

/// The lanes: a ribbon for each track, a glyph for each event that is shown, and the line of the moment.
class TrackDrawing {
  readonly svg: SVGSVGElement;
  private readonly now: SVGLineElement;
  private readonly lanes: ReadonlyMap<number, number>;
  private readonly axis: number;
  private readonly height: number;
  private readonly largestVolume: number;
  private x = (time: number): number => time;

  constructor(private readonly app: App, private readonly host: HTMLElement, private readonly tracks: readonly Track[]) {
    this.lanes = lanesOf(tracks);
    this.axis = app.space.timeAxis;
    this.height = TOP * 2 + LANE * (Math.max(...this.lanes.values()) + 1);
    this.largestVolume = tracks.reduce((largest, track) => Math.max(largest, track.max_volume ?? 0), 0);
    this.svg = svg("svg", { height: this.height, role: "group", "aria-label": "Tracks and events through time" });
    this.now = svg("line", { class: "now", y1: 0, y2: this.height });
  }

  draw(): void {
    const { app, host, svg: drawing } = this;
    const width = Math.max(120, host.clientWidth);
    // The sides are those of the slider below: where the middle of its handle, 16 wide, stands at either end.
    const slider = element("scrub").getBoundingClientRect();
    const side = slider.left - host.getBoundingClientRect().left + 8;
    const { minimum, maximum } = app.space.axes[this.axis]!;
    this.x = (time) => side + ((slider.width - 16) * (time - minimum)) / (maximum - minimum || 1);
    drawing.replaceChildren();
    drawing.setAttribute("viewBox", `0 0 ${width} ${this.height}`);
    for (const event of app.allEvents) this.drawLinks(event);
    const shown = app.chosenEvents().filter((event) => [...event.in, ...event.out].some((id) => this.lanes.has(id)));
    const named = this.namedOf(shown);
    const extents = shown.map((event) => this.extentOf(event, named.has(event)));
    for (const track of this.tracks) drawing.append(this.lane(track, extents));
    const byWeight = [...shown].sort((a, b) => Number(isMinor(b.type)) - Number(isMinor(a.type)));
    for (const event of byWeight) drawing.append(this.glyph(event, named.has(event)));
    drawing.append(this.now);
    this.moveNow();
  }
  moveNow(): void {
    const shown = this.app.axis === this.axis;
    this.now.style.display = shown ? "" : "none";
    const at = shown ? this.x(this.app.toPosition(this.app.state.offset)) : 0;
    this.now.setAttribute("x1", String(at));
    this.now.setAttribute("x2", String(at));
  }
  showChosen(track: number): void {
    for (const one of this.svg.querySelectorAll(".lane"))
      one.classList.toggle("chosen", Number(one.getAttribute("data-track")) === track);
  }

  private y(track: number): number {
    return TOP + LANE * (this.lanes.get(track)! + 0.5);
  }
  private drawLinks(event: TrackEvent): void {
    for (const from of event.in)
      for (const to of event.out) {
        if (from === to || !this.lanes.has(from) || !this.lanes.has(to)) continue;
        const at = this.x(event.time);
        this.svg.append(svg("path", { class: "link", d: `M${at} ${this.y(from)} L${at} ${this.y(to)}` }));
      }
  }

  private lane(track: Track, extents: readonly Extent[]): SVGElement {
    const { app, axis } = this;
    const label = `Track ${track.id}, ${app.positionText(axis, track.start_time)} to ${app.positionText(axis, track.end_time)}`;
    const group = svg("g", { class: "lane", tabindex: 0, role: "button", "data-track": track.id, "aria-label": label });
    const begin = this.x(track.start_time), end = Math.max(this.x(track.end_time), begin + 2), middle = this.y(track.id);
    group.append(svg("path", { d: this.ribbon(track, begin, end), fill: labelColour(track.id) }), titleOf(label));
    const text = `track ${track.id}`;
    const place = freePlace(begin + 8, LETTER * text.length, extents.filter((one) => one.lane === middle));
    if (place + LETTER * text.length < end - 8) {
      const name = svg("text", { x: place, y: middle + 4 });
      name.textContent = text;
      group.append(name);
    }
    const light = (on: boolean) => app.set({ highlight: on ? track.id & 0xffff : -1 });
    group.addEventListener("pointerenter", () => light(true));
    group.addEventListener("pointerleave", () => light(false));
    group.addEventListener("focus", () => light(true));
    group.addEventListener("blur", () => light(false));
    group.addEventListener("click", () => app.moveToTime(Math.max(track.start_time, Math.min(track.end_time, app.time))));
    return group;
  }
  /// A bar, or a band as wide as the track is large at each step.
  private ribbon(track: Track, begin: number, end: number): string {
    const middle = this.y(track.id), largest = this.largestVolume;
    const half = (volume: number | undefined) => (volume === undefined || !largest ? 3.5 : 1.5 + 5.5 * Math.sqrt(volume / largest));
    const steps = track.volumes ?? [];
    if (steps.length < 2) {
      const h = half(track.max_volume);
      return `M${begin} ${middle - h}H${end}V${middle + h}H${begin}z`;
    }
    const upper = steps.map(([time, volume]) => `${this.x(time)} ${middle - half(volume)}`);
    const lower = [...steps].reverse().map(([time, volume]) => `${this.x(time)} ${middle + half(volume)}`);
    return `M${begin} ${middle}L${upper.join("L")}L${end} ${middle}L${lower.join("L")}z`;
  }

  /// The track beside which an event that has one in a lane stands.
  private trackOf(event: TrackEvent): number {
    return [...event.out, ...event.in].find((id) => this.lanes.has(id))!;
  }
  /// 1: the name stands to the right of the glyph; -1: to the left, at the end of the line.
  private sideOf(event: TrackEvent): 1 | -1 {
    return this.x(event.time) < this.svg.clientWidth - 80 ? 1 : -1;
  }
  /// What a glyph takes up of its lane, with its name or without.
  private extentOf(event: TrackEvent, named: boolean): Extent {
    const at = this.x(event.time), name = named ? NAME + LETTER * event.type.length : 0, side = this.sideOf(event);
    return { lane: this.y(this.trackOf(event)), low: at - Math.max(GLYPH, side < 0 ? name : 0), high: at + Math.max(GLYPH, side > 0 ? name : 0) };
  }
  /// The events, few enough, whose name has room beside their glyph.
  private namedOf(shown: readonly TrackEvent[]): Set<TrackEvent> {
    const named = new Set<TrackEvent>();
    if (shown.length <= MOST_NAMED)
      for (const event of shown) {
        const others = shown.filter((other) => other !== event).map((other) => this.extentOf(other, named.has(other)));
        if (!others.some((other) => meet(other, this.extentOf(event, true)))) named.add(event);
      }
    return named;
  }
  private glyph(event: TrackEvent, named: boolean): SVGElement {
    const { app } = this;
    const label = eventText(app, event);
    // By the keyboard one goes from event to event, instead of through all of them to the time line.
    const group = svg("g", { class: isMinor(event.type) ? "glyph minor" : "glyph", role: "button", tabindex: -1, "aria-label": label,
      transform: `translate(${this.x(event.time)} ${this.y(this.trackOf(event))})`, "data-event": event.type });
    group.append(glyphOf(event.type), titleOf(label));
    if (named) {
      const side = this.sideOf(event);
      const name = svg("text", { x: 9 * side, y: 4, "text-anchor": side > 0 ? "start" : "end" });
      name.textContent = event.type;
      group.append(name);
    }
    group.addEventListener("click", () => app.showEvent(event));
    group.addEventListener("keydown", (key) => {
      if (key.key === "Enter" || key.key === " ") app.showEvent(event);
    });
    return group;
  }
}

/// What stands below the lanes where another isovalue is shown; calls `show` whenever that may have changed.
function staleNote(app: App, show: (own: boolean) => void): HTMLElement {
  const note = document.createElement("p");
  note.className = "stale";
  const back = document.createElement("button");
  Object.assign(back, { type: "button", textContent: `Back to ${app.initial.isovalue}` });
  back.addEventListener("click", () => app.set({ isovalue: app.initial.isovalue }));
  note.append(`Tracks and events are those of isovalue ${app.initial.isovalue}. `, back);
  const update = (): void => {
    note.hidden = app.isOwnSurface;
    show(app.isOwnSurface);
  };
  update();
  app.onMesh(update);
  return note;
}

export function buildTracking(app: App): void {
  const { tracking } = app.metadata;
  if (!tracking || app.space.timeAxis < 0) return;
  const tracks = tracking.tracks.filter((track) => !track.simplified);
  if (tracks.length === 0) return;
  const host = element("tracking");
  host.hidden = false;
  document.body.classList.add("with-tracks");
  const head = headOf(app, tracks), drawing = new TrackDrawing(app, host, tracks);
  const note = staleNote(app, (own) => {
    head.style.visibility = own ? "" : "hidden";
    drawing.svg.classList.toggle("dimmed", !own);
    drawing.svg.toggleAttribute("inert", !own);
  });
  host.replaceChildren(head, drawing.svg, note);
  app.onChange((state, changed) => {
    if (changed.has("hide")) drawing.draw();
    if (changed.has("offset") || changed.has("frame")) drawing.moveNow();
    if (changed.has("highlight")) drawing.showChosen(state.highlight);
  });
  new ResizeObserver(() => drawing.draw()).observe(host);
  drawing.draw();
}
