// Prints what a page costs: bytes per tetrahedron, time to open, time per frame when time is scrubbed, frames while
// it plays.
//
//   node viewer/test/benchmark.mjs PAGE.html...        (hyperiso view, or make_viewer_pages FILE.html N, makes one)
import { readFileSync, statSync } from "node:fs";
import { openBrowser, openPage, ready } from "./browser.mjs";

const PLAYED = 6; // seconds, of the 10 that a run takes

// Plays from the first moment by the button: the frames drawn, and how far time went.
async function play(page) {
  await page.evaluate(() => {
    const { hyperiso: app } = window;
    app.acrossAxis(app.space.timeAxis);
    const rendered = app.view.afterRender;
    app.drawn = 0;
    app.view.afterRender = (milliseconds) => {
      rendered(milliseconds);
      ++app.drawn;
    };
  });
  await page.click("#play");
  const begin = await page.evaluate(() => [window.hyperiso.drawn, window.hyperiso.time, performance.now()]);
  await page.waitForTimeout(1000 * PLAYED);
  const end = await page.evaluate(() => [window.hyperiso.drawn, window.hyperiso.time, performance.now()]);
  await page.click("#play");
  const reach = await page.evaluate(() => Math.abs(window.hyperiso.toPosition(window.hyperiso.reach) - window.hyperiso.toPosition(-window.hyperiso.reach)));
  const [frames, time, milliseconds] = end.map((value, i) => value - begin[i]);
  return { frames, seconds: milliseconds / 1000, share: time / reach };
}

const browser = await openBrowser();
for (const file of process.argv.slice(2)) {
  const text = readFileSync(file, "latin1");
  // The viewer, and the extraction core where there is one: the first block of a page that holds samples.
  const head = text.indexOf('<script type="application/json"');
  const core = text.slice(head, head + 4000).includes('"samples":{"band"')
    ? text.indexOf("</script>", text.indexOf('class="hyperiso-block"')) - text.indexOf('class="hyperiso-block"') : 0;
  const viewer = head + core;
  const start = performance.now();
  const { page, problems, close } = await openPage(browser, file, { width: 1280, height: 800 });
  await page.waitForFunction(() => document.documentElement.dataset.ready === "true", null, { timeout: 300_000 });
  const opened = (performance.now() - start) / 1000;
  const result = await page.evaluate(async () => {
    const app = window.hyperiso;
    const gl = app.view.renderer.getContext();
    const pixel = new Uint8Array(4);
    const frame = (offset) => {
      const begin = performance.now();
      app.set({ offset });
      app.view.render();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); // waits until it is drawn
      return performance.now() - begin;
    };
    const median = (list) => list.sort((a, b) => a - b)[Math.floor(list.length / 2)];
    const run = () => median(Array.from({ length: 25 }, (_, i) => frame(app.reach * ((2 * (i + 0.5)) / 25 - 1))));
    run();
    const time = run();
    app.turnTo([1, 1, 1, 1]);
    const oblique = run();
    const { mesh } = app;
    const slider = document.getElementById("isovalue");
    let extract = null;
    if (!document.getElementById("isovalue-section").hidden) {
      const begin = performance.now();
      app.set({ isovalue: app.initial.isovalue + 0.001 * (Number(slider.max) - Number(slider.min)) });
      await new Promise((resolve) => app.onMesh(resolve));
      extract = performance.now() - begin;
    }
    return { time, oblique, extract, simplices: mesh.simplexCount, card: (16 * mesh.vertexCount + 16 * mesh.simplexCount) / mesh.simplexCount };
  });
  const played = await play(page);
  const { simplices } = result;
  console.log(`${file}: ${simplices.toLocaleString("en")} tetrahedra`);
  console.log(`  in the file        ${((statSync(file).size - viewer) / simplices).toFixed(2)} bytes per tetrahedron, and ${(viewer / 1e6).toFixed(2)} MB for the viewer`);
  console.log(`  on the card        ${result.card.toFixed(1)} bytes per tetrahedron`);
  console.log(`  opened in          ${opened.toFixed(1)} s`);
  console.log(`  scrubbing time     ${result.time.toFixed(0)} ms per frame`);
  console.log(`  oblique plane      ${result.oblique.toFixed(0)} ms per frame`);
  console.log(`  playing            ${played.frames} frames in ${played.seconds.toFixed(1)} s, through ${(100 * played.share).toFixed(0)} % of time`);
  if (result.extract) console.log(`  another isovalue   ${result.extract.toFixed(0)} ms`);
  if (problems.length) console.log(problems);
  await close();
}
await browser.close();
