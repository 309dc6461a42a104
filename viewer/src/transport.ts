// Playing and scrubbing, the events on the time line, and the keys.
import { type App, element } from "./app";
import { eventText, isMinor } from "./events";
import { readable } from "./space";

const input = (id: string): HTMLInputElement => element<HTMLInputElement>(id);
const select = (id: string): HTMLSelectElement => element<HTMLSelectElement>(id);

const PLAY = "M7 4.5 15.5 10 7 15.5z", PAUSE = "M6.5 5h2v10h-2zM11.5 5h2v10h-2z";

export function buildTransport(app: App): void {
  const scrub = input("scrub");
  scrub.addEventListener("input", () => app.set({ offset: app.toOffset(Number(scrub.value)), playing: false }));
  element("play").addEventListener("click", () => app.togglePlaying());
  element("step-back").addEventListener("click", () => app.step(-1));
  element("step-forward").addEventListener("click", () => app.step(1));
  select("speed").addEventListener("change", () => app.set({ speed: Number(select("speed").value) }));
  select("loop").addEventListener("change", () => app.set({ loop: select("loop").value as "repeat" }));
  app.onChange((state, changed) => {
    select("speed").value = String(state.speed);
    select("loop").value = state.loop;
    if (changed.has("playing")) {
      element("play").setAttribute("aria-label", state.playing ? "Pause" : "Play");
      element("play-icon").setAttribute("d", state.playing ? PAUSE : PLAY);
    }
    if (changed.has("frame") || changed.has("hide")) showRange(app);
    if (changed.has("frame") || changed.has("offset")) showPosition(app);
  });
  app.onMesh(() => {
    showRange(app);
    showPosition(app);
  });
}

function showRange(app: App): void {
  const ends = [app.toPosition(-app.reach), app.toPosition(app.reach)].sort((a, b) => a - b);
  const step = (ends[1]! - ends[0]!) / 100;
  const unit = app.axis >= 0 ? app.space.axes[app.axis]!.unit : "";
  Object.assign(input("scrub"), { min: String(ends[0]), max: String(ends[1]) });
  element("scrub-low").textContent = `${readable(ends[0]!, step)} ${unit}`;
  element("scrub-high").textContent = `${readable(ends[1]!, step)} ${unit}`;
  showMarks(app, ends as [number, number]);
}

function showMarks(app: App, [low, high]: [number, number]): void {
  const marks = element("event-marks");
  marks.replaceChildren();
  if (app.axis !== app.space.timeAxis || app.space.timeAxis < 0) return;
  for (const event of app.events) {
    const mark = document.createElement("button");
    mark.type = "button";
    mark.className = isMinor(event.type) ? "mark minor" : "mark";
    mark.tabIndex = -1; // the keys [ and ] go through them
    mark.style.left = `${(100 * (event.time - low)) / (high - low || 1)}%`;
    mark.title = eventText(app, event);
    mark.setAttribute("aria-label", mark.title);
    mark.addEventListener("click", () => app.showEvent(event));
    marks.append(mark);
  }
}

function showPosition(app: App): void {
  const position = app.toPosition(app.state.offset);
  input("scrub").value = String(position);
  const text = app.positionText(app.axis, position);
  input("scrub").setAttribute("aria-valuetext", text);
  const output = element("position");
  const detail = document.createElement("small");
  detail.textContent = stepText(app, position);
  output.replaceChildren(text, detail);
  element("empty").hidden = app.surface.cutChunkCount > 0;
  element("empty").textContent = app.mesh.simplexCount > 0 ? "The plane meets no part of the surface here."
    : `There is no surface${app.metadata.isovalue === undefined ? "" : ` at isovalue ${app.shownIsovalue}`}.`;
}

function stepText(app: App, position: number): string {
  if (app.axis < 0) return "oblique, from the middle";
  const samples = app.space.axes[app.axis]!.samples;
  if (samples < 2) return `plane across ${app.space.axes[app.axis]!.name}`;
  const stops = app.stops();
  const below = Math.max(0, stops.findLastIndex((x) => x <= position + 1e-9 * Math.abs(position)));
  const next = stops[below + 1];
  const share = next === undefined ? 0 : (position - stops[below]!) / (next - stops[below]!);
  const at = share < 1e-6 ? String(below) : (below + share).toFixed(1);
  const isLevel = app.metadata.levels && app.axis === app.space.dimension - 1;
  return `${app.axis === app.space.timeAxis ? "step" : isLevel ? "level" : "sample"} ${at} of ${samples - 1}`;
}

export function buildKeys(app: App, save: { picture(): void }): void {
  const help = element<HTMLDialogElement>("help");
  const showHelp = (): void => {
    help.showModal();
    help.scrollTop = 0; // the button that closes it, which has the focus now, is at its end
  };
  element("help-button").addEventListener("click", showHelp);
  const time = app.space.timeAxis;
  element("help-text").textContent = app.space.dimension === 4
    ? `The picture is the cut of a surface in four dimensions (${app.space.axes.map((axis) => axis.name).join(", ")}) by a plane` +
      `${time >= 0 ? `. Across ${app.space.axes[time]!.name} it shows a moment, and playing moves it through time; across another axis, or oblique, it mixes space and time` : ""}.`
    : "The picture is the surface. The plane draws a line on it.";
  element("event-keys").hidden = app.allEvents.length === 0;

  const keys: Record<string, (event: KeyboardEvent) => void> = {
    " ": () => app.togglePlaying(),
    ArrowLeft: (event) => app.step(event.shiftKey ? -10 : -1),
    ArrowRight: (event) => app.step(event.shiftKey ? 10 : 1),
    Home: () => app.step(-1e9),
    End: () => app.step(1e9),
    "[": () => app.stepEvent(-1),
    "]": () => app.stepEvent(1),
    r: () => app.resetView("home"),
    f: () => app.resetView("front"),
    s: () => app.resetView("right"),
    t: () => app.resetView("top"),
    "+": () => app.view.dolly(0.85),
    "=": () => app.view.dolly(0.85),
    "-": () => app.view.dolly(1 / 0.85),
    a: () => app.set({ axes: !app.state.axes }),
    w: () => app.set({ wireframe: !app.state.wireframe }),
    o: () => app.set({ projection: app.state.projection === "perspective" ? "orthographic" : "perspective" }),
    c: nextColouring,
    d: () => app.set({ theme: app.dark() ? "light" : "dark" }),
    p: () => save.picture(),
    "?": showHelp,
    "5": () => app.diagonal(),
    Escape: () => app.set({ highlight: -1 }),
  };
  app.space.axes.forEach((_, k) => (keys[String(k + 1)] = () => app.acrossAxis(k)));
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || help.open) return;
    const target = event.target as HTMLElement;
    const own = target.matches("input[type=number], select, textarea") ||
      (target.matches("button, summary, input[type=checkbox], .lane, .glyph") && (event.key === " " || event.key === "Enter")) ||
      (target.matches("input[type=range]:not(#scrub)") && /^(Arrow|Home|End|Page)/.test(event.key));
    const action = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (own || !action) return;
    event.preventDefault();
    action(event);
  });
}

function nextColouring(): void {
  const list = select("colour");
  list.selectedIndex = (list.selectedIndex + 1) % list.options.length;
  list.dispatchEvent(new Event("change"));
}
