// From an opened file to a page that works.
import { App, element } from "./app";
import { FieldSource } from "./field";
import { buildIsovalue } from "./isovalue";
import { type Mesh, MeshReader, readAttributes } from "./mesh";
import type { Metadata } from "./metadata";
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

const pause = () => new Promise((resolve) => setTimeout(resolve, 0));

async function readSurface(metadata: Metadata, space: Space, title: string): Promise<Mesh> {
  const reader = new MeshReader(metadata);
  const count = metadata.blocks!.length;
  let done = 0;
  for await (const block of documentBlocks(count)) {
    reader.add(block);
    report(`Reading ${title}`, ++done / count);
  }
  report(`Preparing ${title}`, 1);
  await pause();
  return reader.finish(space);
}

/// The worker with the samples of the page, and the attributes of the surface at the page's isovalue.
async function readField(metadata: Metadata, title: string): Promise<{ source: FieldSource; attributes: Uint16Array[] }> {
  const { blocks } = metadata.samples!;
  const hasAttributes = metadata.attributes.length > 0;
  const count = 1 + blocks.length + Number(hasAttributes);
  let source: FieldSource | null = null, attributes: Uint16Array[] = [];
  let done = 0;
  for await (const block of documentBlocks(count)) {
    if (!source) source = new FieldSource(metadata, block);
    else if (done <= blocks.length) source.add(blocks[done - 1]!, block);
    else attributes = readAttributes(block, metadata.attributes.length, metadata.vertices);
    report(`Reading ${title}`, ++done / count);
  }
  return { source: source!, attributes };
}

async function firstSurface(metadata: Metadata, title: string, source: FieldSource): Promise<Mesh> {
  source.onProgress = (share) => report(`Extracting the surface of ${title}`, share);
  source.onProgress(0);
  const mesh = (await source.surface(metadata.isovalue!))!;
  if (mesh.vertexCount !== metadata.vertices || mesh.simplexCount !== metadata.simplices)
    throw new Error("its surface comes out another than the one that was written");
  return mesh;
}

async function main(): Promise<void> {
  const dark = !matchMedia("(prefers-color-scheme: light)").matches;
  document.documentElement.dataset["theme"] = dark ? "dark" : "light";
  const metadata = await documentMetadata();
  const title = metadata.title || "Isosurface";
  element("title").textContent = title;
  checkGraphics(metadata.vertices, metadata.simplices);

  const space = new Space(metadata);
  let source: FieldSource | null = null, attributes: Uint16Array[] = [];
  let mesh: Mesh;
  if (metadata.samples) {
    ({ source, attributes } = await readField(metadata, title));
    mesh = { ...(await firstSurface(metadata, title, source)), attributes };
  } else {
    mesh = await readSurface(metadata, space, title);
  }
  const app = new App(mesh, space, metadata, metadata.samples && !metadata.samples.band ? source!.range() : null);
  buildPanel(app);
  buildTransport(app);
  buildPicking(app);
  buildTracking(app);
  buildKeys(app, buildSaving(app, notice));
  await buildIsovalue(app, source, attributes, notice);
  const subtitle = (): void => {
    element("subtitle").textContent = [metadata.field && metadata.field !== title ? metadata.field : "",
      metadata.levels ? `isovalues ${space.axes.at(-1)!.minimum} to ${space.axes.at(-1)!.maximum}` : metadata.isovalue === undefined ? "" : `isovalue ${app.shownIsovalue}`,
      metadata.part].filter(Boolean).join(" · ");
  };
  subtitle();
  app.onMesh(subtitle);
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
