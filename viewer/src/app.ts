// What holds the page together: the state, and what follows from a change of it.
import type { Vector3 } from "three";
import { rgb, type Rgb } from "./colours";
import { eventLines } from "./events";
import { axisFrame, axisOf, dot, type Frame, reachOf, turnedTo } from "./frame";
import { componentsOf, type Mesh } from "./mesh";
import { type Metadata, samplesOf, type TrackEvent } from "./metadata";
import { SceneView } from "./scene";
import { cut, type Triangles } from "./slice";
import { readable, type Space, type Vector4 } from "./space";
import { fromHash, initialState, type State, toHash } from "./state";
import { Surface } from "./surface";

/// A way to colour the surface.
export interface Colouring {
  key: string;
  name: string;
  kind: "solid" | "range" | "label";
  range: [number, number]; // of all data
  diverging?: boolean; // the range lies around 0
}

export const NO_TRACK = 0xffff; // of what begins and ends between two steps

const RUN_SECONDS = 10; // a whole run at speed 1

export const element = <T extends Element = HTMLElement>(id: string): T => {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no element ${id}`);
  return found as unknown as T;
};

export class App {
  readonly initial: State;
  state: State;
  readonly surface: Surface;
  readonly view: SceneView;
  readonly colourings: Colouring[];
  readonly allEvents: readonly TrackEvent[]; // but for those left out as small or short, by time
  private readonly simplified: ReadonlySet<number>; // tracks
  private readonly listeners: ((state: State, changed: Set<keyof State>) => void)[] = [];
  private shownValues = ""; // what the graphics card has of each vertex
  private components: { count: number; ofVertex: Uint32Array } | null = null;
  private playedAt = 0;
  private direction = 1;
  private hashTimer = 0;
  readonly frameTimes: number[] = [];
  private readonly meshListeners: (() => void)[] = [];
  shownIsovalue: number; // that of the surface, which comes a little later than it is asked for

  constructor(public mesh: Mesh, readonly space: Space, readonly metadata: Metadata,
    private readonly isovalues: [number, number] | null) {
    this.surface = new Surface(mesh, space);
    this.view = new SceneView(element("stage"), element("view"), element("labels"), element("legend"), space, this.surface);
    this.allEvents = (metadata.tracking?.events ?? []).filter((event) => !event.simplified && !event.type.startsWith("open"))
      .sort((a, b) => a.time - b.time);
    this.simplified = new Set(metadata.tracking?.tracks.filter((track) => track.simplified).map((track) => track.id));
    this.colourings = this.listColourings();
    this.initial = this.valid(initialState(metadata, space));
    this.state = this.initial;
    this.shownIsovalue = this.initial.isovalue;
    this.view.controls.addEventListener("end", () => this.set({ camera: this.view.pose().map((x) => Number(x.toPrecision(6))) }));
    this.view.afterRender = (milliseconds) => {
      this.frameTimes.push(milliseconds);
      if (this.frameTimes.length > 200) this.frameTimes.shift();
    };
    matchMedia("(prefers-color-scheme: light)").addEventListener("change", () => this.applyTheme());
    addEventListener("hashchange", () => {
      if (location.hash.slice(1) !== toHash(this.state, this.initial, this.space))
        this.set({ ...this.valid(fromHash(location.hash, this.initial, this.space)), playing: this.state.playing });
    });
  }

  /// Shows the state that the address asks for. Call once, when the listeners are there.
  start(): void {
    this.state = this.valid(fromHash(location.hash, this.initial, this.space));
    this.changed(new Set(Object.keys(this.state) as (keyof State)[]));
    if (!this.state.camera) this.view.look("home");
  }

  private valid(state: State): State {
    const known = this.colourings.some((one) => one.key === state.colour);
    const own = this.metadata.isovalue ?? 0; // which may be none of the samples'
    const [low, high] = this.isovalues ?? [own, own];
    const isovalue = Math.max(Math.min(low, own), Math.min(Math.max(high, own), state.isovalue));
    const hide = state.hide.split(",").filter((type) => this.allEvents.some((event) => event.type === type)).join();
    return { ...state, isovalue, hide, colour: known ? state.colour : "solid" };
  }

  /// Shows another surface: that of the same field at another isovalue.
  useMesh(mesh: Mesh, isovalue: number): void {
    this.mesh = mesh;
    this.shownIsovalue = isovalue;
    this.components = null;
    this.shownValues = "";
    this.surface.replace(mesh);
    this.view.setFrame(this.state.frame, this.state.offset);
    this.view.marker = null;
    this.applyColour();
    for (const listener of this.meshListeners) listener();
    this.view.request();
  }
  onMesh(listener: () => void): void {
    this.meshListeners.push(listener);
  }
  /// Whether the surface is the one that the tracks and attributes of the page belong to.
  get isOwnSurface(): boolean {
    return this.shownIsovalue === this.initial.isovalue;
  }
  /// Those that are neither hidden by their type nor another isovalue's.
  get events(): readonly TrackEvent[] {
    return this.isOwnSurface ? this.chosenEvents() : [];
  }
  chosenEvents(): readonly TrackEvent[] {
    const hidden = this.hiddenTypes();
    return hidden.length ? this.allEvents.filter((event) => !hidden.includes(event.type)) : this.allEvents;
  }
  /// Whether a track is left out as small or short.
  isSimplified(track: number): boolean {
    return this.simplified.has(track);
  }
  hiddenTypes(): string[] {
    return this.state.hide.split(",").filter(Boolean);
  }
  showType(type: string, shown: boolean): void {
    const others = this.hiddenTypes().filter((one) => one !== type);
    this.set({ hide: (shown ? others : [...others, type]).sort().join() });
  }

  onChange(listener: (state: State, changed: Set<keyof State>) => void): void {
    this.listeners.push(listener);
  }

  set(change: Partial<State>): void {
    const changed = new Set((Object.keys(change) as (keyof State)[]).filter((key) => change[key] !== this.state[key]));
    if (changed.size === 0) return;
    this.state = { ...this.state, ...change };
    this.changed(changed);
  }

  private changed(changed: Set<keyof State>): void {
    const { state, view, surface } = this;
    const has = (...keys: (keyof State)[]) => keys.some((key) => changed.has(key));
    if (has("axes")) view.showAxes = state.axes;
    if (has("frame", "offset")) {
      view.setFrame(state.frame, state.offset);
      if (view.marker) view.marker = null;
    }
    if (has("theme")) this.applyTheme();
    if (has("colour", "map", "reversed", "range", "highlight", "theme")) this.applyColour();
    if (has("opacity")) surface.setOpacity(state.opacity);
    if (has("wireframe", "theme")) surface.setWireframe(state.wireframe, this.dark() ? 2 : 1);
    if (has("clipAxis", "clipAt", "clipFlip", "box", "frame")) this.applyClip();
    if (has("hideBeyond", "frame", "offset")) this.applySection();
    if (has("projection")) view.setProjection(state.projection);
    if (has("camera") && state.camera) this.moveCamera(state.camera);
    if (has("playing") && state.playing) this.startPlaying();
    for (const listener of this.listeners) listener(state, changed);
    if (!state.playing) this.rememberSoon();
    view.request();
  }

  private moveCamera(pose: readonly number[]): void {
    if (this.view.pose().some((x, i) => Math.abs(x - pose[i]!) > 1e-5)) this.view.setPose(pose);
  }

  private rememberSoon(): void {
    clearTimeout(this.hashTimer);
    this.hashTimer = window.setTimeout(() => {
      const hash = toHash(this.state, this.initial, this.space);
      if (location.hash.slice(1) !== hash) history.replaceState(null, "", hash ? `#${hash}` : location.pathname + location.search);
    }, 250);
  }
  link(): string {
    return location.href.split("#")[0] + "#" + toHash(this.state, this.initial, this.space);
  }

  // The plane ---------------------------------------------------------------------------------------------

  get axis(): number {
    return axisOf(this.state.frame);
  }
  get reach(): number {
    return reachOf(this.space, this.state.frame);
  }

  acrossAxis(k: number): void {
    const frame = axisFrame(this.space, k);
    const atFirst = k === this.space.timeAxis ? -1 : 0;
    this.set({ frame, offset: atFirst * reachOf(this.space, frame), playing: false });
    if (this.space.dimension === 4) this.resetView();
  }
  diagonal(): void {
    const normal = [1, 1, 1, this.space.dimension === 4 ? 1 : 0] as Vector4;
    this.turnTo(normal);
    this.resetView();
  }
  /// Turns the plane about the middle of the domain to a normal of the scene; false for one without a direction.
  turnTo(normal: Vector4): boolean {
    const largest = Math.max(...normal.map(Math.abs));
    if (!(largest > 0 && largest < Infinity)) return false;
    this.useFrame(turnedTo(this.space, this.state.frame, normal.map((x) => x / largest) as Vector4));
    return true;
  }
  useFrame(frame: Frame): void {
    const reach = reachOf(this.space, frame);
    this.set({ frame, offset: Math.max(-reach, Math.min(reach, this.state.offset)) });
  }

  /// Positions of the plane for people: the axis's own coordinates, or the distance from the middle.
  toPosition(offset: number): number {
    return this.axis >= 0 ? this.space.coordinate(this.axis, offset * this.state.frame[3][this.axis]!) : offset;
  }
  toOffset(position: number): number {
    return this.axis >= 0 ? this.space.scene(this.axis, position) * this.state.frame[3][this.axis]! : position;
  }
  moveTo(position: number): void {
    const offset = this.toOffset(position);
    this.set({ offset: Math.max(-this.reach, Math.min(this.reach, offset)) });
  }
  /// The positions that steps go to.
  stops(): number[] {
    const samples = this.axis >= 0 ? samplesOf(this.space.axes[this.axis]!) : [];
    if (samples.length) return samples;
    const low = this.toPosition(-this.reach), high = this.toPosition(this.reach);
    return Array.from({ length: 101 }, (_, i) => low + ((high - low) * i) / 100);
  }
  step(count: number): void {
    const stops = this.stops(), here = this.toPosition(this.state.offset);
    const near = 1e-6 * (stops[stops.length - 1]! - stops[0]!);
    const at = count > 0 ? stops.findLastIndex((x) => x <= here + near) : stops.findIndex((x) => x >= here - near);
    this.set({ playing: false });
    this.moveTo(stops[Math.max(0, Math.min(stops.length - 1, at + count))]!);
  }
  stepEvent(direction: 1 | -1): void {
    // From another plane, the first or the last of all.
    const here = this.axis === this.space.timeAxis ? this.toPosition(this.state.offset) : -direction * Infinity;
    const near = 1e-6 * (this.toPosition(this.reach) - this.toPosition(-this.reach));
    const next = direction > 0 ? this.events.find((event) => event.time > here + near)
      : this.events.findLast((event) => event.time < here - near);
    if (next) this.showEvent(next);
  }
  showEvent(event: TrackEvent): void {
    this.moveToTime(event.time);
    this.mark(this.picturePoint(event), eventLines(this, event));
  }
  /// Says something beside a point of the picture, and to those who do not see that.
  mark(point: Vector3, lines: readonly string[]): void {
    this.view.marker = { point, text: lines.join("\n") };
    element("said").textContent = lines.join(", ");
    this.view.request();
  }
  /// Where an event is in the picture, which in R^3 has time as one of its directions.
  private picturePoint({ position, time }: TrackEvent): Vector3 {
    const { timeAxis } = this.space;
    const scene = this.space.axes.map((_, k) => this.space.scene(k, k === timeAxis ? time : position[k]!));
    const at = this.view.controls.target.clone();
    [0, 1, 2].forEach((row) => at.setComponent(row, dot(this.state.frame[row]!, scene)));
    return at;
  }

  /// The time shown; the first one while the plane is not across time.
  get time(): number {
    const axis = this.space.timeAxis;
    return this.axis === axis ? this.toPosition(this.state.offset) : this.space.axes[axis]!.minimum;
  }
  moveToTime(time: number): void {
    if (this.axis !== this.space.timeAxis) this.acrossAxis(this.space.timeAxis);
    this.set({ playing: false });
    this.moveTo(time);
  }

  /// "t = 0.500 s"; `finer`: how many times as fine as a tenth of a step.
  positionText(axis: number, position: number, finer = 1): string {
    if (axis < 0) return `offset ${readable(position, 0.001)}`;
    const { name, unit, minimum, maximum, samples } = this.space.axes[axis]!;
    const step = samples > 1 ? (maximum - minimum) / (samples - 1) / 10 : (maximum - minimum) / 1000;
    return `${name} = ${readable(position, step / finer)}${unit ? " " + unit : ""}`;
  }

  slice(): Triangles {
    return cut(this.mesh, this.space, this.state.frame, this.state.offset);
  }

  // Playing -----------------------------------------------------------------------------------------------

  togglePlaying(): void {
    if (!this.state.playing && this.state.loop === "once" && this.state.offset >= this.reach * (1 - 1e-9))
      this.set({ offset: -this.reach });
    this.set({ playing: !this.state.playing });
  }
  private startPlaying(): void {
    this.playedAt = performance.now();
    const tick = () => {
      if (!this.state.playing) return;
      const now = performance.now();
      this.advance(Math.min(0.25, (now - this.playedAt) / 1000));
      this.playedAt = now;
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }
  advance(seconds: number): void {
    const { reach } = this;
    if (this.state.loop !== "bounce") this.direction = 1;
    let offset = this.state.offset + (this.direction * seconds * this.state.speed * 2 * reach) / RUN_SECONDS;
    const out = offset > reach || offset < -reach;
    if (out && this.state.loop === "bounce") {
      this.direction = -this.direction;
      offset = Math.max(-reach, Math.min(reach, offset));
    } else if (out && this.state.loop === "repeat") {
      offset = -reach;
    } else if (out) {
      this.set({ offset: reach, playing: false });
      return;
    }
    this.set({ offset });
  }

  // Looks -------------------------------------------------------------------------------------------------

  resetView(view: "home" | "front" | "right" | "top" = "home"): void {
    this.view.look(view);
    this.set({ camera: view === "home" ? null : this.view.pose().map((x) => Number(x.toPrecision(6))) });
  }

  dark(): boolean {
    return this.state.theme === "dark" || (this.state.theme === "auto" && !matchMedia("(prefers-color-scheme: light)").matches);
  }
  private applyTheme(): void {
    document.documentElement.dataset["theme"] = this.dark() ? "dark" : "light";
    const style = getComputedStyle(document.documentElement);
    const colour = (name: string) => style.getPropertyValue(name).trim();
    this.view.palette = { line: colour("--outline"), text: colour("--text"), background: [colour("--top"), colour("--bottom")] };
    this.surface.uniforms.sectionColour.value.set(...rgb(colour("--event")));
    this.surface.uniforms.solid.value.set(...(rgb(this.dark() ? "#6aaef2" : "#4c93dc") as Rgb));
    this.view.request();
  }

  private listColourings(): Colouring[] {
    const { metadata, space } = this;
    const list: Colouring[] = [{ key: "solid", name: "One colour", kind: "solid", range: [0, 1] }];
    if (metadata.tracking || metadata.attributes.some((one) => one.kind === "label" && /^track(_id)?$/.test(one.name)))
      list.push({ key: "track", name: "Track", kind: "label", range: [0, 1] });
    list.push({ key: "component", name: "Component", kind: "label", range: [0, 1] });
    if (space.timeAxis === 3) {
      const fastest = this.typicalSpeed();
      list.push({ key: "speed", name: "Speed" + this.speedUnit(), kind: "range", range: [-fastest, fastest], diverging: true });
    }
    metadata.attributes.forEach((one, k) => {
      if (one.kind === "label" && /^track(_id)?$/.test(one.name)) return;
      list.push({ key: `attribute:${k}`, name: one.name, kind: one.kind === "label" ? "label" : "range",
        range: one.kind === "label" ? [0, 1] : [one.minimum, one.maximum] });
    });
    metadata.axes.forEach((axis, k) =>
      list.push({ key: k === space.timeAxis ? "time" : `axis:${k}`, name: k === space.timeAxis ? "Time, " + space.label(k) : space.label(k),
        kind: "range", range: [axis.minimum, axis.maximum] }));
    return list.filter((one) => one.key !== "track" || this.trackAttribute() >= 0);
  }
  trackAttribute(): number {
    return this.metadata.attributes.findIndex((one) => one.kind === "label" && /^track(_id)?$/.test(one.name));
  }
  private speedUnit(): string {
    const length = this.space.axes[0]!.unit, time = this.space.axes[3]!.unit;
    return length || time ? ` (${length || "1"}/${time || "step"})` : "";
  }
  speedScale(): number {
    return this.space.unit[0]! / this.space.unit[3]!;
  }
  /// The speed that nine of ten vertices stay below.
  private typicalSpeed(): number {
    const { normals, vertexCount } = this.mesh;
    const speeds: number[] = [];
    const stride = Math.max(1, Math.floor(vertexCount / 20000));
    for (let vertex = 0; vertex < vertexCount; vertex += stride) {
      const at = 4 * vertex;
      const across = Math.hypot(normals[at]!, normals[at + 1]!, normals[at + 2]!);
      speeds.push(Math.abs(normals[at + 3]!) / Math.max(across, 1e-3));
    }
    speeds.sort((a, b) => a - b);
    const speed = (speeds[Math.floor(0.9 * speeds.length)] ?? 0) * this.speedScale();
    return speed > 0 ? Number(speed.toPrecision(2)) : 1;
  }

  get colouring(): Colouring {
    return this.colourings.find((one) => one.key === this.state.colour && this.canColourBy(one.key)) ?? this.colourings[0]!;
  }
  canColourBy(key: string): boolean {
    return this.isOwnSurface || !(key === "track" || key.startsWith("attribute:"));
  }
  colourRange(): [number, number] {
    return this.state.range ?? this.colouring.range;
  }

  private applyColour(): void {
    const { uniforms } = this.surface;
    const { state, colouring, space } = this;
    const values = /^(component|track|attribute:)/.test(colouring.key) ? colouring.key : "none";
    if (this.shownValues !== values && (values !== "none" || this.shownValues === "")) this.uploadValues(values);
    this.surface.setMap(state.map, state.reversed);
    uniforms.highlight.value = state.highlight;
    const [low, high] = this.colourRange();
    const axis = colouring.key === "time" ? space.timeAxis : colouring.key.startsWith("axis:") ? Number(colouring.key.slice(5)) : -1;
    if (axis >= 0) {
      uniforms.colourMode.value = 1;
      uniforms.colourAxis.value.set(...([0, 1, 2, 3].map((k) => (k === axis ? 1 : 0)) as Vector4));
      uniforms.colourRange.value.set(space.scene(axis, low), space.scene(axis, high));
    } else if (colouring.key === "speed") {
      uniforms.colourMode.value = 2;
      uniforms.colourRange.value.set(low / this.speedScale(), high / this.speedScale());
    } else if (colouring.kind === "range") {
      const [first, last] = colouring.range;
      uniforms.colourMode.value = 3;
      uniforms.colourRange.value.set((low - first) / (last - first || 1), (high - first) / (last - first || 1));
    } else {
      uniforms.colourMode.value = colouring.kind === "label" ? 4 : 0;
    }
  }

  private uploadValues(key: string): void {
    this.shownValues = key;
    const tracks = this.trackOfVertex();
    const values = key === "component" ? this.componentOfVertex() : key === "track" ? tracks
      : key.startsWith("attribute:") ? this.mesh.attributes[Number(key.slice(10))]! : null;
    this.surface.setValues(values, tracks);
  }
  componentOfVertex(): Uint32Array {
    this.components ??= componentsOf(this.mesh);
    return this.components.ofVertex;
  }
  componentCount(): number {
    this.componentOfVertex();
    return this.components!.count;
  }
  /// Of each vertex the id of its track or NO_TRACK; null where the surface has none, as at other isovalues than the
  /// page's own.
  trackOfVertex(): Uint16Array | null {
    const k = this.trackAttribute();
    const attribute = this.metadata.attributes[k];
    if (attribute?.kind !== "label" || !this.isOwnSurface) return null;
    return this.mesh.attributes[k]!.map((level) => attribute.labels[level]! & NO_TRACK);
  }

  private applyClip(): void {
    const { state } = this;
    const { uniforms } = this.surface;
    const half = [0, 1, 2].map((row) => this.pictureHalf(row));
    if (state.clipAxis < 0) {
      uniforms.clip.value.set(0, 0, 0, 1);
    } else {
      const sign = state.clipFlip ? -1 : 1;
      const normal = [0, 1, 2].map((row) => (row === state.clipAxis ? sign : 0)) as [number, number, number];
      uniforms.clip.value.set(...normal, sign * (2 * state.clipAt - 1) * half[state.clipAxis]!);
    }
    const side = (at: number) => half.map((h, row) => {
      const share = state.box[2 * row + at]!;
      return at === 0 ? (share <= 0 ? -99 : (2 * share - 1) * h) : share >= 1 ? 99 : (2 * share - 1) * h;
    }) as [number, number, number];
    uniforms.boxLow.value.set(...side(0));
    uniforms.boxHigh.value.set(...side(1));
  }
  /// How far the domain reaches along a direction of the picture.
  pictureHalf(row: number): number {
    return this.state.frame[row]!.reduce((sum, x, k) => sum + Math.abs(x) * this.space.half[k]!, 0);
  }
  /// Names of the directions of the picture.
  pictureAxis(row: number): string {
    const axis = this.state.frame[row]!.findIndex((x) => Math.abs(Math.abs(x) - 1) < 1e-6);
    return axis >= 0 && axis < this.space.dimension ? this.space.axes[axis]!.name : ["→", "↗", "↑"][row]!;
  }

  private applySection(): void {
    const { uniforms } = this.surface;
    const shown = this.space.dimension === 3 && (this.space.timeAxis >= 0 || this.state.offset < this.reach * (1 - 1e-6));
    uniforms.sectionMode.value = !shown ? 0 : this.state.hideBeyond ? 2 : 1;
  }
}
