// The controls beside the picture.
import { type App, element } from "./app";
import { COLOUR_MAPS, labelColour, mapGradient } from "./colours";
import { axisFrame, rotated } from "./frame";
import { useNumbers } from "./numbers";
import { readable, type Vector4 } from "./space";
import type { State } from "./state";

const input = (id: string): HTMLInputElement => element<HTMLInputElement>(id);
const select = (id: string): HTMLSelectElement => element<HTMLSelectElement>(id);

function option(list: HTMLSelectElement, value: string, text: string): void {
  list.add(new Option(text, value));
}

function labelled(text: string, control: HTMLElement): HTMLLabelElement {
  const label = document.createElement("label");
  label.append(text + " ", control);
  return label;
}

function slider(low: number, high: number, value: number, name: string): HTMLInputElement {
  const control = document.createElement("input");
  Object.assign(control, { type: "range", min: String(low), max: String(high), step: "any", value: String(value) });
  control.setAttribute("aria-label", name);
  return control;
}

export function buildPanel(app: App): void {
  buildPresets(app);
  buildTilts(app);
  buildColour(app);
  buildView(app);
  buildClip(app);
  element<HTMLDetailsElement>("about").open = app.metadata.notes.length > 0;
  buildAbout(app);
  app.onMesh(() => buildAbout(app));
}

/// What the plane makes of the surface, in a line.
function planeText(app: App): string {
  const { axes, dimension, timeAxis } = app.space;
  if (app.axis < 0) return dimension === 4 ? "A plane across several axes: it mixes space and time." : "A line on the surface, across several axes.";
  const name = axes[app.axis]!.name;
  if (app.axis === timeAxis) return "A moment. Play moves through time.";
  if (app.metadata.levels && app.axis === dimension - 1) return "One isovalue. Play moves through them.";
  const others = axes.filter((_, k) => k !== app.axis).map((axis) => axis.name);
  return dimension === 4 ? `All of ${others.join(", ")} at one ${name}. Play moves through ${name}.` : `A line on the surface, at one ${name}.`;
}

function buildPresets(app: App): void {
  const presets = element("presets");
  const buttons: { axis: number; button: HTMLButtonElement }[] = [];
  const add = (axis: number, text: string, title: string, use: () => void): void => {
    const button = document.createElement("button");
    Object.assign(button, { type: "button", textContent: text, title });
    button.addEventListener("click", use);
    presets.append(button);
    buttons.push({ axis, button });
  };
  const order = app.space.axes.map((_, k) => k);
  if (app.space.timeAxis >= 0 || app.metadata.levels) order.unshift(order.pop()!);
  for (const k of order)
    add(k, app.space.axes[k]!.name, `Plane across ${app.space.axes[k]!.name}`, () => app.acrossAxis(k));
  add(-1, "oblique", "A plane across all axes; tilt it below", () => app.diagonal());
  app.onChange((_, changed) => {
    if (!changed.has("frame")) return;
    for (const { axis, button } of buttons) button.setAttribute("aria-pressed", String(axis === app.axis));
    element("slice-hint").textContent = planeText(app);
  });
}

function buildTilts(app: App): void {
  const { axes, dimension } = app.space;
  const rotations = element("rotations");
  const sliders: { control: HTMLInputElement; used: number }[] = [];
  if (dimension === 4)
    for (let i = 0; i < 4; ++i)
      for (let j = i + 1; j < 4; ++j) {
        const short = [axes[i]!.name, axes[j]!.name].map((name) => name.slice(0, 3));
        const name = short.join(short.some((one) => one.length > 1) ? " " : "");
        const control = slider(-180, 180, 0, `Rotate in the plane of ${axes[i]!.name} and ${axes[j]!.name}, degrees`);
        const entry = { control, used: 0 };
        // The slider tells how far to turn from where it stood: turns of different planes do not commute.
        control.addEventListener("input", () => {
          const angle = Number(control.value);
          app.useFrame(rotated(app.state.frame, i, j, ((angle - entry.used) * Math.PI) / 180));
          entry.used = angle;
        });
        sliders.push(entry);
        rotations.append(labelled(name, control));
      }
  else element("tilts").hidden = true;

  const inputs = axes.map((axis) => {
    const control = document.createElement("input");
    Object.assign(control, { type: "number", step: "any" });
    element("normal-inputs").append(labelled(axis.name, control));
    return control;
  });
  element("normal-form").addEventListener("submit", (event) => event.preventDefault());
  const showNormal = useNumbers({
    inputs,
    note: element("normal-note"),
    inForce: () => axes.map((_, k) => app.state.frame[3][k]!),
    text: (value) => readable(value, 0.01),
    use: (values) => (app.turnTo([0, 1, 2, 3].map((k) => values[k] ?? 0) as Vector4) ? "" : "One of them has to differ from 0."),
  });
  input("hide-beyond").addEventListener("change", () => app.set({ hideBeyond: input("hide-beyond").checked }));
  element("hide-row").hidden = dimension === 4;

  app.onChange((state, changed) => {
    if (changed.has("hideBeyond")) input("hide-beyond").checked = state.hideBeyond;
    if (!changed.has("frame")) return;
    showNormal();
    const preset = app.axis >= 0 && state.frame.flat().every((x, i) => x === axisFrame(app.space, app.axis).flat()[i]);
    if (preset) for (const entry of sliders) entry.control.value = String((entry.used = 0));
  });
}

function buildColour(app: App): void {
  for (const one of app.colourings) option(select("colour"), one.key, one.name);
  for (const name of Object.keys(COLOUR_MAPS)) option(select("map"), name, name);
  select("colour").addEventListener("change", () => {
    const chosen = app.colourings.find((one) => one.key === select("colour").value)!;
    const { map } = app.state;
    const fitting = chosen.diverging ? "blue to red" : map === "blue to red" ? "viridis" : map;
    app.set({ colour: chosen.key, range: null, map: fitting, highlight: -1 });
  });
  select("map").addEventListener("change", () => app.set({ map: select("map").value }));
  input("reversed").addEventListener("change", () => app.set({ reversed: input("reversed").checked }));
  const showRange = useNumbers({
    inputs: [input("range-low"), input("range-high")],
    note: element("range-note"),
    inForce: () => app.colourRange(),
    text: (value) => rangeText(app, value),
    use: ([low, high]) => {
      if (low! >= high!) return "From has to be below to.";
      app.set({ range: [low!, high!] });
      return "";
    },
  });
  element("range-reset").addEventListener("click", () => {
    app.set({ range: null });
    showRange();
  });
  input("opacity").addEventListener("input", () => app.set({ opacity: Number(input("opacity").value) }));

  app.onChange((state, changed) => {
    select("colour").value = state.colour;
    select("map").value = state.map;
    input("reversed").checked = state.reversed;
    input("opacity").value = String(state.opacity);
    if (["colour", "map", "reversed", "range"].some((key) => changed.has(key as keyof State))) {
      showRange();
      showLegend(app);
    }
  });
  app.onMesh(() => {
    for (const one of select("colour").options) one.disabled = !app.canColourBy(one.value);
    showRange();
    showLegend(app);
  });
}

/// An end of the range, with the digits that its length asks for.
function rangeText(app: App, end: number): string {
  const [low, high] = app.colourRange();
  return readable(end, (high - low) / 100);
}

function showLegend(app: App): void {
  const { colouring, state } = app;
  const ranged = colouring.kind === "range";
  element("map-controls").hidden = !ranged;
  element("legend").hidden = colouring.kind === "solid";
  element("legend-name").textContent = colouring.name;
  if (ranged) {
    element("legend-bar").style.background = mapGradient(state.map, state.reversed);
    app.colourRange().forEach((end, i) => (element(i ? "legend-high" : "legend-low").textContent = rangeText(app, end)));
  } else if (colouring.kind === "label") {
    const labels = shownLabels(app);
    const width = 100 / Math.min(12, labels.length);
    const stops = labels.slice(0, 12).map((label, i) => `${labelColour(label)} ${width * i}% ${width * (i + 1)}%`);
    element("legend-bar").style.background = `linear-gradient(to right, ${stops.join(", ")})`;
    const what = colouring.key === "component" ? "component" : colouring.key === "track" ? "track" : "value";
    element("legend-low").textContent = `${labels.length} ${what}${labels.length === 1 ? "" : "s"}`;
    element("legend-high").textContent = "";
  }
}

/// The labels of the colouring that is shown: as the graphics card has them.
function shownLabels(app: App): number[] {
  const range = (count: number): number[] => Array.from({ length: count }, (_, i) => i);
  if (app.colouring.key === "component") return range(app.componentCount());
  if (app.colouring.key === "track" && app.metadata.tracking) return app.metadata.tracking.tracks.map((track) => track.id);
  const attribute = app.metadata.attributes[app.colouring.key === "track" ? app.trackAttribute() : Number(app.colouring.key.slice(10))];
  return attribute?.kind === "label" ? (app.colouring.key === "track" ? attribute.labels : range(attribute.labels.length)) : [];
}

function buildView(app: App): void {
  for (const button of document.querySelectorAll<HTMLButtonElement>("[data-view]"))
    button.addEventListener("click", () => app.resetView(button.dataset["view"] as "home"));
  input("orthographic").addEventListener("change", () =>
    app.set({ projection: input("orthographic").checked ? "orthographic" : "perspective" }));
  input("axes").addEventListener("change", () => app.set({ axes: input("axes").checked }));
  input("wireframe").addEventListener("change", () => app.set({ wireframe: input("wireframe").checked }));
  element("theme").addEventListener("click", () => app.set({ theme: app.dark() ? "light" : "dark" }));
  const panel = element("panel"), toggle = element("panel-button");
  const open = (shown: boolean): void => {
    panel.classList.toggle("open", shown);
    toggle.setAttribute("aria-expanded", String(shown));
  };
  toggle.addEventListener("click", () => open(!panel.classList.contains("open")));
  element("view").addEventListener("pointerdown", () => open(false));
  app.onChange((state) => {
    input("orthographic").checked = state.projection === "orthographic";
    input("axes").checked = state.axes;
    input("wireframe").checked = state.wireframe;
  });
}

function buildClip(app: App): void {
  const box = element("box");
  const sliders = [0, 1, 2].flatMap((row) => {
    const line = document.createElement("div");
    line.className = "span";
    const name = document.createElement("span");
    const pair = ["low", "high"].map((side, at) => slider(0, 1, at, `Box, ${side} end of axis ${row + 1} of the picture`));
    pair.forEach((control, at) => control.addEventListener("input", () => {
      const next = [...app.state.box];
      next[2 * row + at] = Number(control.value);
      const other = 2 * row + 1 - at;
      next[other] = at === 0 ? Math.max(next[other]!, next[2 * row]!) : Math.min(next[other]!, next[2 * row + 1]!);
      app.set({ box: next });
    }));
    line.append(name, ...pair);
    box.append(line);
    return pair;
  });
  option(select("clip-axis"), "-1", "none");
  for (const row of [0, 1, 2]) option(select("clip-axis"), String(row), "");
  select("clip-axis").addEventListener("change", () => app.set({ clipAxis: Number(select("clip-axis").value) }));
  input("clip-at").addEventListener("input", () => app.set({ clipAt: Number(input("clip-at").value) }));
  input("clip-flip").addEventListener("change", () => app.set({ clipFlip: input("clip-flip").checked }));
  element("clip-reset").addEventListener("click", () => app.set({ clipAxis: -1, box: [0, 1, 0, 1, 0, 1] }));
  app.onChange((state, changed) => {
    if (changed.has("frame"))
      for (const row of [0, 1, 2]) {
        select("clip-axis").options[row + 1]!.text = `across ${app.pictureAxis(row)}`;
        box.children[row]!.firstElementChild!.textContent = app.pictureAxis(row);
      }
    select("clip-axis").value = String(state.clipAxis);
    element("clip-controls").hidden = state.clipAxis < 0;
    input("clip-at").value = String(state.clipAt);
    input("clip-flip").checked = state.clipFlip;
    sliders.forEach((control, i) => (control.value = String(state.box[i])));
  });
}

function buildAbout(app: App): void {
  const { metadata, space } = app;
  element("about-text").replaceChildren();
  const lines: string[] = [];
  if (metadata.isovalue !== undefined)
    lines.push(`Isosurface of ${metadata.field || "the field"} at ${app.shownIsovalue}${metadata.part ? `, where ${metadata.part}` : ""}.`);
  const count = (n: number): string => n.toLocaleString("en");
  const { mesh } = app;
  const kind = mesh.corners === 4 ? "tetrahedra in four dimensions" : "triangles";
  lines.push(`${count(mesh.simplexCount)} ${kind}, ${count(mesh.vertexCount)} vertices.`);
  for (const [k, axis] of space.axes.entries()) {
    const step = (axis.maximum - axis.minimum) / 1000;
    const range = `${axis.name}: ${readable(axis.minimum, step)} to ${readable(axis.maximum, step)}`;
    lines.push(`${[range, axis.unit].filter(Boolean).join(" ")}${axis.samples ? `, ${count(axis.samples)} samples` : ""}${k === space.timeAxis ? " (time)" : ""}.`);
  }
  if (metadata.levels)
    lines.push("A cut across isovalue is the isosurface at that value; between two levels it runs linearly from one surface to the other.");
  else if (mesh.corners === 4)
    lines.push("Between two steps the field is interpolated linearly, so every moment is a true cut of one surface in space and time.");
  if (metadata.tracking?.regions) lines.push("The tracks are those of the regions that the surface bounds.");
  const paragraph = (text: string, className = ""): void => {
    const p = document.createElement("p");
    p.textContent = text;
    p.className = className;
    element("about-text").append(p);
  };
  for (const note of metadata.notes) paragraph(note, "note");
  for (const line of lines) paragraph(line);
  paragraph("Made with hyperiso. This file holds all it needs: it works without a network.");
}
