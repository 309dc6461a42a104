// From an opened file to a page that works.
import { App, element } from "./app";
import { MeshReader } from "./mesh";
import { documentBlocks, documentMetadata } from "./origin";
import { buildPanel } from "./panel";
import { buildPicking } from "./pick";
import { buildSaving } from "./save";
import { Space } from "./space";
import { buildTracking } from "./tracking";
import { buildKeys, buildTransport } from "./transport";

function report(text: string, share: number): void {
  element("loading-text").textContent = text;
  element<HTMLProgressElement>("loading-bar").value = share;
}

function fail(error: unknown): void {
  element("loading").hidden = false;
  element("loading").classList.add("failed");
  element("loading").setAttribute("role", "alert");
  const what = error instanceof Error ? error.message : String(error);
  element("loading-text").textContent = `This page cannot be shown: ${what}.`;
}

function checkGraphics(vertices: number, simplices: number): void {
  const context = document.createElement("canvas").getContext("webgl2");
  if (!context) throw new Error("this browser has no WebGL 2, or it is switched off");
  const rows = context.getParameter(context.MAX_TEXTURE_SIZE) as number;
  context.getExtension("WEBGL_lose_context")?.loseContext();
  if (Math.max(vertices, simplices) > rows * 2048)
    throw new Error(`this graphics card holds ${(rows * 2048).toLocaleString("en")} simplices, the surface has ${simplices.toLocaleString("en")}`);
}

let noticeTimer = 0;
function notice(text: string): void {
  element("notice").textContent = text;
  element("notice").hidden = false;
  clearTimeout(noticeTimer);
  noticeTimer = window.setTimeout(() => (element("notice").hidden = true), 3000);
}

async function main(): Promise<void> {
  const dark = !matchMedia("(prefers-color-scheme: light)").matches;
  document.documentElement.dataset["theme"] = dark ? "dark" : "light";
  const metadata = await documentMetadata();
  const title = metadata.title || "Isosurface";
  element("title").textContent = title;
  element("subtitle").textContent = [metadata.field && metadata.field !== title ? metadata.field : "",
    metadata.isovalue === undefined ? "" : `isovalue ${metadata.isovalue}`].filter(Boolean).join(" · ");
  checkGraphics(metadata.vertices, metadata.simplices);

  const space = new Space(metadata);
  const reader = new MeshReader(metadata);
  const count = metadata.blocks.length;
  let done = 0;
  for await (const block of documentBlocks(count)) {
    reader.add(block);
    report(`Reading ${title}`, ++done / count);
  }
  report(`Preparing ${title}`, 1);
  await new Promise((resolve) => setTimeout(resolve, 0));

  const app = new App(reader.finish(space), space, metadata);
  buildPanel(app);
  buildTransport(app);
  buildPicking(app);
  buildTracking(app);
  buildKeys(app, buildSaving(app, notice));
  app.start();
  element("view").addEventListener("webglcontextlost", (event) => {
    event.preventDefault();
    fail(new Error("the graphics card gave up; reload the page"));
  });
  element("loading").hidden = true;
  Object.assign(window, { hyperiso: app });
  document.documentElement.dataset["ready"] = "true";
}

main().catch(fail);
