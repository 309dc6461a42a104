// Makes the pictures of docs/viewer.md.
//
//   hyperiso view examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 --track --payload field --colour-by speed --title "Dam break" -o water.html
//   node viewer/test/pictures.mjs water.html docs/images
import { openBrowser, openPage, ready } from "./browser.mjs";

const [file, folder] = process.argv.slice(2);
const wide = { width: 1060, height: 690 };
const pictures = [
  ["viewer", wide, (app) => app.moveTo(0.6)],
  ["viewer_early", wide, (app) => app.moveTo(0.3)],
  ["viewer_light", { ...wide, colorScheme: "light" }, (app) => app.moveTo(0.9)],
  ["viewer_oblique", wide, (app) => {
    app.diagonal();
    app.set({ offset: -0.6, colour: "time", map: "viridis" });
  }],
  ["viewer_tracks", wide, (app) => {
    app.set({ colour: "track" });
    app.showEvent(app.events.find((event) => event.type === "merge" && event.time > 0.8));
  }],
  ["viewer_isovalue", { ...wide, colorScheme: "light" }, async (app) => {
    app.moveTo(0.7);
    app.set({ isovalue: 0.9 });
    await new Promise((resolve) => app.onMesh(resolve));
  }],
  ["viewer_phone", { width: 390, height: 800, touch: true }, (app) => app.moveTo(0.6)],
];

const browser = await openBrowser();
for (const [name, options, set] of pictures) {
  const { page, problems, close } = await openPage(browser, file, options);
  await ready(page);
  await page.evaluate(`(${set})(window.hyperiso)`);
  await page.waitForTimeout(500); // what fades
  await page.screenshot({ path: `${folder}/${name}.png` });
  if (problems.length) console.log(name, problems);
  await close();
}
await browser.close();
