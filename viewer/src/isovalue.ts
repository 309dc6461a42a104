// The isovalue: of a page that holds the field, chosen while it is shown.
import { type App, element } from "./app";
import type { FieldSource } from "./field";
import { useNumbers } from "./numbers";
import { readable } from "./space";

const SVG = "http://www.w3.org/2000/svg";
const BINS = 96;

/// Shows surfaces as isovalues are asked for, the latest first of all; the page goes on meanwhile.
export async function buildIsovalue(app: App, source: FieldSource | null,
  attributes: Uint16Array[], notice: (text: string) => void): Promise<void> {
  if (!source || app.metadata.samples!.band) return;
  const section = element<HTMLDetailsElement>("isovalue-section");
  const slider = element<HTMLInputElement>("isovalue"), number = element<HTMLInputElement>("isovalue-number");
  const back = element<HTMLButtonElement>("isovalue-back"), bar = element<HTMLProgressElement>("isovalue-progress");
  const own = app.initial.isovalue;
  const { counts, low, high } = await source.histogram(BINS);
  const step = (high - low) / 1000 || 1;
  section.hidden = false;
  Object.assign(slider, { min: String(low), max: String(high) });
  element("isovalue-low").textContent = readable(low, step);
  element("isovalue-high").textContent = readable(high, step);
  back.textContent = `Back to ${own}`;
  drawHistogram(counts, (own - low) / (high - low || 1));

  slider.addEventListener("input", () => app.set({ isovalue: Number(Number(slider.value).toPrecision(6)) }));
  const showNumber = useNumbers({
    inputs: [number],
    note: element("isovalue-note"),
    inForce: () => [app.state.isovalue],
    text: String,
    use: ([value]) => {
      app.set({ isovalue: value === own ? own : Math.max(low, Math.min(high, value!)) });
      return "";
    },
  });
  back.addEventListener("click", () => app.set({ isovalue: own }));

  let asked = app.shownIsovalue;
  source.onProgress = (share) => (bar.value = share);
  app.onChange((state, changed) => {
    if (!changed.has("isovalue")) return;
    showNumber();
    slider.value = String(state.isovalue);
    slider.setAttribute("aria-valuetext", String(state.isovalue));
    back.disabled = state.isovalue === own;
    if (state.isovalue === asked) return;
    asked = state.isovalue;
    bar.style.visibility = "visible";
    source.surface(asked).then((mesh) => {
      if (mesh) app.useMesh({ ...mesh, attributes: state.isovalue === own ? attributes : [] }, state.isovalue);
      if (app.shownIsovalue === asked) bar.style.visibility = "hidden";
    }, (error: Error) => {
      notice(`No surface at ${state.isovalue}: ${error.message}`);
      bar.style.visibility = "hidden";
    });
  });
}

/// How the samples spread over the values; logarithms, since a few values often have most of the samples.
function drawHistogram(counts: number[], own: number): void {
  const drawing = document.createElementNS(SVG, "svg");
  drawing.setAttribute("viewBox", `0 0 ${counts.length} 32`);
  drawing.setAttribute("preserveAspectRatio", "none");
  const largest = Math.log1p(Math.max(1, ...counts));
  const bars = document.createElementNS(SVG, "path");
  bars.setAttribute("d", counts.map((count, i) => `M${i} 32V${(32 - (31 * Math.log1p(count)) / largest).toFixed(2)}h1V32z`).join(""));
  drawing.append(bars);
  if (own >= 0 && own <= 1) {
    const mark = document.createElementNS(SVG, "path");
    mark.setAttribute("class", "own");
    mark.setAttribute("d", `M${(own * counts.length).toFixed(2)} 0V32`);
    drawing.append(mark);
  }
  element("histogram").replaceChildren(drawing);
}
