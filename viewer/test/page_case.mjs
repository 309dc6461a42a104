// What the tests of pages share: a browser, and what a reader does with a page.
//
//   HYPERISO_PAGES=FOLDER node --test viewer/test      (pages by make_viewer_pages)
import assert from "node:assert/strict";
import { dirname, join } from "node:path";
import { after, before } from "node:test";
import { fileURLToPath } from "node:url";
import { buildSync } from "esbuild";
import { openBrowser, openPage, ready } from "./browser.mjs";

export const folder = process.env.HYPERISO_PAGES;
export const here = dirname(fileURLToPath(import.meta.url));
const probe = buildSync({ entryPoints: [join(here, "probe.ts")], bundle: true, write: false, format: "iife" }).outputFiles[0].text;
export let browser;
before(async () => { browser = await openBrowser(); });
after(async () => { await browser?.close(); });

export async function open(name, options) {
  const opened = await openPage(browser, join(folder, name), options);
  await ready(opened.page);
  await opened.page.evaluate(probe);
  return opened;
}
export const picture = (page) => page.evaluate(() => probe.picture());
export const state = (page, key) => page.evaluate((key) => hyperiso.state[key], key);
export const position = (page) => page.evaluate(() => hyperiso.toPosition(hyperiso.state.offset));
export const near = (a, b, tolerance = 1e-6) => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);
export const openSection = (page, name) => page.evaluate((name) => {
  for (const one of document.querySelectorAll("#panel details"))
    if (one.querySelector("summary").textContent === name) one.open = true;
}, name);
/// Waits until so many frames have been drawn.
export const frames = (page, count) => page.evaluate((count) => new Promise((resolve) => {
  const next = () => (count-- > 0 ? requestAnimationFrame(next) : resolve());
  next();
}), count);
/// Opens the controls of a page on a phone, and waits until they stand still.
export const openPanel = async (page) => {
  await page.tap("#panel-button");
  await page.waitForFunction(() => {
    const panel = document.getElementById("panel");
    return getComputedStyle(panel).visibility === "visible" && panel.getAnimations().length === 0;
  });
};
/// Clicks the point of the surface that is nearest to the eye; gives where that is.
export async function clickSurface(page) {
  const place = await page.evaluate(() => {
    const { positions } = hyperiso.slice();
    let best = 0;
    const eye = hyperiso.view.camera.position;
    const distance = (i) => Math.hypot(positions[i] - eye.x, positions[i + 1] - eye.y, positions[i + 2] - eye.z);
    for (let i = 0; i < hyperiso.slice().count * 9; i += 9) if (distance(i) < distance(best)) best = i;
    const centre = [0, 1, 2].map((k) => (positions[best + k] + positions[best + 3 + k] + positions[best + 6 + k]) / 3);
    return { at: hyperiso.view.project(eye.clone().fromArray(centre)), centre };
  });
  await page.click("#view", { position: { x: place.at[0], y: place.at[1] } });
  return place.centre;
}
/// Moves a slider as a hand does: the value, and the event that tells.
export const slide = (page, selector, value) => page.$eval(selector, (element, value) => {
  element.value = value;
  element.dispatchEvent(new Event("input", { bubbles: true }));
}, String(value));
