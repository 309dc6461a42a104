// What a reader finds on the page: each control is used and what it changes is asserted.
//
//   HYPERISO_PAGES=FOLDER node --test viewer/test      (pages by make_viewer_pages)
import assert from "node:assert/strict";
import { copyFileSync, existsSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join, relative } from "node:path";
import { after, before, describe, test } from "node:test";
import { fileURLToPath } from "node:url";
import { buildSync } from "esbuild";
import { openBrowser, openPage, PATIENCE, ready } from "./browser.mjs";

const folder = process.env.HYPERISO_PAGES;
const here = dirname(fileURLToPath(import.meta.url));
const probe = buildSync({ entryPoints: [join(here, "probe.ts")], bundle: true, write: false, format: "iife" }).outputFiles[0].text;
let browser;
before(async () => { browser = await openBrowser(); });
after(async () => { await browser?.close(); });

async function open(name, options) {
  const opened = await openPage(browser, join(folder, name), options);
  await ready(opened.page);
  await opened.page.evaluate(probe);
  return opened;
}
const picture = (page) => page.evaluate(() => probe.picture());
const state = (page, key) => page.evaluate((key) => hyperiso.state[key], key);
const position = (page) => page.evaluate(() => hyperiso.toPosition(hyperiso.state.offset));
const near = (a, b, tolerance = 1e-6) => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);
const openSection = (page, name) => page.evaluate((name) => {
  for (const one of document.querySelectorAll("#panel details"))
    if (one.querySelector("summary").textContent === name) one.open = true;
}, name);
/// Waits until so many frames have been drawn.
const frames = (page, count) => page.evaluate((count) => new Promise((resolve) => {
  const next = () => (count-- > 0 ? requestAnimationFrame(next) : resolve());
  next();
}), count);
/// Opens the controls of a page on a phone, and waits until they stand still.
const openPanel = async (page) => {
  await page.tap("#panel-button");
  await page.waitForFunction(() => {
    const panel = document.getElementById("panel");
    return getComputedStyle(panel).visibility === "visible" && panel.getAnimations().length === 0;
  });
};
/// Clicks the point of the surface that is nearest to the eye; gives where that is.
async function clickSurface(page) {
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
const slide = (page, selector, value) => page.$eval(selector, (element, value) => {
  element.value = value;
  element.dispatchEvent(new Event("input", { bubbles: true }));
}, String(value));

describe("the page of a surface in space and time", () => {
  let page, problems, close;
  before(async () => { ({ page, problems, close } = await open("blobs.html")); });
  after(async () => { await close?.(); });
  const reset = () => page.evaluate(() => {
    hyperiso.set({ ...hyperiso.initial });
    hyperiso.resetView();
  });

  test("says what it shows, with names and units", async () => {
    assert.equal(await page.title(), "gaussians");
    assert.equal(await page.textContent("#title"), "gaussians");
    assert.equal(await page.textContent("#subtitle"), "density · isovalue 0.5");
    assert.match(await page.textContent("#position"), /^t = 0\.000 sstep 0 of 20$/);
    assert.match(await page.textContent("#about-text"), /Every second sample was left out.*tetrahedra.*x: -1\.000 to 1\.000 mm, 24 samples/s);
    assert.ok(await page.isHidden("#loading"));
  });

  test("has a name for every control", async () => {
    const nameless = await page.evaluate(() => [...document.querySelectorAll("button, input, select")].filter((control) =>
      !(control.getAttribute("aria-label") || control.textContent.trim() || control.closest("label")?.textContent.trim())).map((one) => one.outerHTML));
    assert.deepEqual(nameless, []);
  });

  test("the first step shows its surface: two balls of known area", async () => {
    await reset();
    // exp(-r^2 / 0.08) = 0.5; the blobs are far apart then
    const radius = Math.sqrt(0.08 * Math.log(2));
    const area = await page.evaluate(() => probe.area());
    near(area / (2 * 4 * Math.PI * radius ** 2), 1, 0.06);
  });

  test("the graphics card and the CPU cut alike, at several times and on oblique planes", async () => {
    await reset();
    for (const time of [0, 0.05, 0.333, 0.5, 0.61803, 1]) {
      await page.evaluate((time) => hyperiso.moveTo(time), time);
      const masks = await page.evaluate(() => probe.compareMasks());
      assert.ok(masks.gpu > 1000, `nothing at ${time}`);
      assert.ok(masks.differing <= 2, `${masks.differing} pixels differ at ${time}`);
    }
    for (const normal of [[1, 0, 0, 0], [0, 1, 0, 0], [1, 1, 1, 1], [0.3, -0.2, 0.1, 0.9], [-0.5, 0.1, 0.7, -0.4]])
      for (const offset of [-0.1, 0.07]) {
        await page.evaluate(([normal, offset]) => {
          hyperiso.turnTo(normal);
          hyperiso.set({ offset });
        }, [normal, offset]);
        const masks = await page.evaluate(() => probe.compareMasks());
        assert.ok(masks.gpu > 500, `nothing on ${normal}`);
        assert.ok(masks.differing <= 2, `${masks.differing} of ${masks.gpu} pixels differ on ${normal} at ${offset}`);
      }
  });

  test("draws only the chunks that the plane meets", async () => {
    await reset();
    for (const time of [0.2, 0.525, 0.9]) {
      const [drawn, meant, all] = await page.evaluate((time) => {
        hyperiso.moveTo(time);
        const { mesh, surface, space } = hyperiso;
        const level = (time - space.axes[3].origin) / space.axes[3].scale;
        let meant = 0;
        for (let at = 0; at < mesh.boxes.length; at += 8) meant += mesh.boxes[at + 3] <= level && level <= mesh.boxes[at + 7];
        return [surface.cutChunkCount, meant, mesh.boxes.length / 8];
      }, time);
      assert.equal(drawn, meant);
      assert.ok(drawn < 0.2 * all, `${drawn} of ${all}`);
    }
  });

  test("plays, pauses, at a speed, and to and fro", async () => {
    await reset();
    await page.click("#play");
    assert.equal(await page.getAttribute("#play", "aria-label"), "Pause");
    await page.waitForFunction(() => hyperiso.toPosition(hyperiso.state.offset) > 0.03);
    await page.click("#play");
    assert.equal(await page.getAttribute("#play", "aria-label"), "Play");
    const stopped = await position(page);
    await frames(page, 10);
    assert.equal(await position(page), stopped);

    await page.selectOption("#speed", "4");
    near(await page.evaluate(() => {
      hyperiso.moveTo(0);
      hyperiso.advance(0.5);
      return hyperiso.toPosition(hyperiso.state.offset);
    }), 0.2, 1e-9);
    await page.selectOption("#loop", "once");
    assert.deepEqual(await page.evaluate(() => {
      hyperiso.set({ playing: true });
      hyperiso.advance(99);
      return [hyperiso.toPosition(hyperiso.state.offset), hyperiso.state.playing];
    }), [1, false]);
    await page.selectOption("#loop", "bounce");
    assert.deepEqual(await page.evaluate(() => {
      hyperiso.advance(1);
      hyperiso.advance(0.25);
      return Number(hyperiso.toPosition(hyperiso.state.offset).toFixed(6));
    }), 0.9);
    await page.selectOption("#loop", "repeat");
    assert.equal(await page.evaluate(() => {
      hyperiso.moveTo(1);
      hyperiso.advance(1);
      return hyperiso.toPosition(hyperiso.state.offset);
    }), 0);
  });

  test("steps and scrubs, by buttons, slider and keys", async () => {
    await reset();
    await page.click("#step-forward");
    near(await position(page), 0.05);
    await page.click("#step-forward");
    await page.click("#step-back");
    near(await position(page), 0.05);
    await slide(page, "#scrub", 0.62);
    near(await position(page), 0.62);
    assert.match(await page.textContent("#position"), /^t = 0\.620 sstep 12\.4 of 20$/);
    await page.focus("#view");
    await page.keyboard.press("ArrowRight");
    near(await position(page), 0.65);
    await page.keyboard.press("ArrowLeft");
    near(await position(page), 0.6);
    await page.keyboard.press("Shift+ArrowLeft");
    near(await position(page), 0.1);
    await page.keyboard.press("End");
    near(await position(page), 1);
    await page.keyboard.press("Home");
    near(await position(page), 0);
    await page.keyboard.press(" ");
    assert.equal(await state(page, "playing"), true);
    await page.keyboard.press(" ");
    assert.equal(await state(page, "playing"), false);
  });

  test("cuts across each axis, and obliquely", async () => {
    await reset();
    for (const [k, name] of ["x", "y", "z", "t"].entries()) {
      await page.click(`#presets button:text-is("${name}")`);
      assert.deepEqual(await page.evaluate(() => hyperiso.state.frame[3]), [0, 1, 2, 3].map((i) => Number(i === k)));
      assert.match(await page.textContent("#position"), new RegExp(`^${name} = .* ${name === "t" ? "s" : "mm"}`));
      assert.equal(await page.getAttribute(`#presets button:text-is("${name}")`, "aria-pressed"), "true");
      const others = ["x", "y", "z", "t"].filter((one) => one !== name).join(", ");
      assert.equal(await page.textContent("#slice-hint"),
        name === "t" ? "A moment. Play moves through time." : `All of ${others} at one ${name}. Play moves through ${name}.`);
    }
    await page.click('#presets button:text-is("oblique")');
    assert.match(await page.textContent("#slice-hint"), /mixes space and time/);
    assert.deepEqual(await page.evaluate(() => hyperiso.state.frame[3].map((x) => Number(x.toFixed(9)))), [0.5, 0.5, 0.5, 0.5]);
    await page.keyboard.press("2");
    assert.equal(await page.evaluate(() => hyperiso.axis), 1);
    await page.keyboard.press("5");
    assert.equal(await page.evaluate(() => hyperiso.axis), -1);
  });

  test("a free normal, continuously; and rotations in all six planes", async () => {
    await reset();
    const inputs = page.locator("#normal-inputs input");
    await inputs.nth(0).fill("1");
    await inputs.nth(0).press("Enter");
    await inputs.nth(0).blur();
    near(await page.evaluate(() => hyperiso.state.frame[3][0]), Math.SQRT1_2, 1e-9);
    for (let i = 0; i < 6; ++i) {
      await reset();
      const before = await picture(page);
      const frame = await page.evaluate(() => hyperiso.state.frame.flat());
      const slider = page.locator("#rotations input").nth(i);
      await slider.evaluate((element) => { element.value = "30"; element.dispatchEvent(new Event("input")); });
      const turned = await page.evaluate(() => hyperiso.state.frame.flat());
      near(turned.reduce((sum, x, k) => sum + x * frame[k], 0), 2 + 2 * Math.cos(Math.PI / 6), 1e-9);
      assert.notEqual((await picture(page)).sum, before.sum);
      await slider.evaluate((element) => { element.value = "0"; element.dispatchEvent(new Event("input")); });
      const back = await page.evaluate(() => hyperiso.state.frame.flat());
      back.forEach((x, k) => near(x, frame[k], 1e-9));
    }
  });

  test("colours by everything there is, with a legend in the right units", async () => {
    await reset();
    const seen = new Set();
    const options = await page.$$eval("#colour option", (list) => list.map((one) => [one.value, one.textContent]));
    assert.deepEqual(options.map(([value]) => value), ["solid", "component", "speed", "axis:0", "axis:1", "axis:2", "time"]);
    await page.evaluate(() => hyperiso.moveTo(0.4));
    for (const [value, name] of options) {
      await page.selectOption("#colour", value);
      const { mean } = await picture(page);
      seen.add(mean.map((x) => x.toFixed(1)).join());
      assert.equal(await page.isVisible("#legend"), value !== "solid");
      if (value !== "solid") assert.equal(await page.textContent("#legend-name"), name);
    }
    assert.ok(seen.size >= 6, `${seen.size} different pictures`);
    assert.equal(options.find(([value]) => value === "speed")[1], "Speed (mm/s)");
    await page.selectOption("#colour", "component");
    assert.match(await page.textContent("#legend"), /1 component/);
    await page.selectOption("#colour", "axis:2");
    assert.deepEqual(await page.$$eval("#legend-ends span", (list) => list.map((one) => one.textContent)), ["-1.00", "1.00"]);
  });

  test("speed is that of the surface: blobs that approach, the outer sides inwards", async () => {
    const speeds = await page.evaluate(() => {
      const { mesh, space } = hyperiso, result = [];
      for (let vertex = 0; vertex < mesh.vertexCount; ++vertex) {
        const [x, , , t] = [0, 1, 2, 3].map((k) => space.coordinate(k, mesh.levels[4 * vertex + k] * space.scale[k] + space.shift[k]));
        const n = mesh.normals.subarray(4 * vertex, 4 * vertex + 4);
        if (t > 0.1 && t < 0.3 && n[0] < -0.9 * Math.hypot(n[0], n[1], n[2]) && x < 0)
          result.push((-n[3] / Math.hypot(n[0], n[1], n[2])) * hyperiso.speedScale());
      }
      return result;
    });
    assert.ok(speeds.length > 5);
    // The left blob moves to the right: its left side moves against its outward normal.
    for (const speed of speeds) assert.ok(speed < -0.2 && speed > -2, String(speed));
  });

  test("maps, reversed, over a range", async () => {
    await reset();
    await page.selectOption("#colour", "axis:2");
    const sums = new Set();
    for (const map of await page.$$eval("#map option", (list) => list.map((one) => one.value))) {
      await page.selectOption("#map", map);
      sums.add((await picture(page)).sum);
    }
    assert.equal(sums.size, 6);
    const plain = await picture(page);
    await page.check("#reversed");
    assert.notEqual((await picture(page)).sum, plain.sum);
    await page.fill("#range-low", "0");
    await page.press("#range-low", "Enter");
    assert.deepEqual(await state(page, "range"), [0, 1]);
    assert.equal(Number(await page.textContent("#legend-low")), 0);
    await page.click("#range-reset");
    assert.equal(await state(page, "range"), null);
  });

  test("numbers that cannot be used are marked while one is among them, and give way to those in force", async () => {
    await reset();
    await page.selectOption("#colour", "axis:2");
    const invalid = (selector) => page.getAttribute(selector, "aria-invalid");
    await page.fill("#range-low", "2"); // on the way to 2 to 3
    await page.press("#range-low", "Tab");
    assert.equal(await page.evaluate(() => document.activeElement.id), "range-high");
    assert.deepEqual([await page.inputValue("#range-low"), await invalid("#range-low"), await state(page, "range")], ["2", "true", null]);
    assert.equal(await page.textContent("#range-note"), "From has to be below to.");
    await page.keyboard.type("3"); // what was there is selected
    await page.keyboard.press("Enter");
    assert.deepEqual([await invalid("#range-low"), await page.textContent("#range-note")], [null, ""]);
    assert.deepEqual(await state(page, "range"), [2, 3]);
    for (const leave of [() => page.press("#range-high", "Tab"), () => page.press("#range-high", "Escape"), () => page.click("#range-high + *, #view", { position: { x: 20, y: 300 } })]) {
      for (const [value, what] of [["1", "From has to be below to."], ["", "This needs a number."]]) {
        await page.fill("#range-high", value);
        await page.press("#range-high", "Enter");
        assert.deepEqual([await page.textContent("#range-note"), await invalid("#range-high")], [what, "true"]);
      }
      await leave();
      assert.deepEqual([await page.inputValue("#range-high"), await invalid("#range-high"), await state(page, "range")], ["3.00", null, [2, 3]]);
    }

    const normal = page.locator("#normal-inputs input");
    const values = () => normal.evaluateAll((list) => list.map((one) => Number(one.value)));
    await normal.nth(3).fill("0");
    await normal.nth(3).press("Enter");
    assert.equal(await page.textContent("#normal-note"), "One of them has to differ from 0.");
    assert.deepEqual([await page.evaluate(() => hyperiso.axis), await values()], [3, [0, 0, 0, 0]]);
    await normal.nth(0).fill("5"); // right with the other one
    await normal.nth(0).press("Enter");
    assert.deepEqual([await page.evaluate(() => hyperiso.axis), await values(), await page.textContent("#normal-note")], [0, [1, 0, 0, 0], ""]);
    await normal.nth(0).fill("0");
    await normal.nth(0).press("Enter");
    await page.focus("#play");
    assert.deepEqual(await values(), [1, 0, 0, 0]);
    // What a box has no digits for is not lost when another one changes.
    await page.evaluate(() => hyperiso.turnTo([1, 0.123456, 0, 1]));
    await normal.nth(2).fill("1");
    await normal.nth(2).press("Enter");
    const [x, y] = await page.evaluate(() => hyperiso.state.frame[3]);
    near(y / x, 0.123456, 1e-9);
    await reset();
  });

  test("opacity, wireframe, axes, projection", async () => {
    await reset();
    await page.evaluate(() => hyperiso.set({ axes: false }));
    const plain = await picture(page);
    await page.evaluate(() => hyperiso.set({ axes: true }));
    await slide(page, "#opacity", 0.4);
    const clear = await picture(page);
    assert.ok(clear.sum !== plain.sum && (await state(page, "opacity")) === 0.4);
    await reset();
    await page.check("#wireframe");
    assert.notEqual((await picture(page)).sum, plain.sum);
    await page.uncheck("#wireframe");
    await page.uncheck("#axes");
    assert.equal((await picture(page)).sum, plain.sum);
    const ink = () => page.$eval("#labels", (canvas) => canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.some((x) => x > 0));
    assert.equal(await ink(), false);
    await page.check("#axes");
    await picture(page);
    assert.equal(await ink(), true);
    await page.check("#orthographic");
    assert.equal(await page.evaluate(() => hyperiso.view.camera === hyperiso.view.orthographic), true);
    assert.notEqual((await picture(page)).sum, plain.sum);
    await page.keyboard.press("o");
    assert.equal(await state(page, "projection"), "perspective");
  });

  test("standard views, reset, and turning, moving, zooming by mouse", async () => {
    await reset();
    const eye = () => page.evaluate(() => hyperiso.view.camera.position.toArray());
    const home = await eye();
    await page.click('[data-view="front"]');
    near((await eye())[0], 0, 1e-6);
    assert.ok((await eye())[1] < -1);
    await page.click('[data-view="right"]');
    assert.ok((await eye())[0] > 1);
    await page.click('[data-view="top"]');
    assert.ok((await eye())[2] > 1);
    await page.click('[data-view="home"]');
    (await eye()).forEach((x, k) => near(x, home[k], 1e-6));

    const stage = await page.locator("#view").boundingBox();
    const middle = [stage.x + stage.width / 2, stage.y + stage.height / 2];
    const drag = async (button) => {
      await page.mouse.move(...middle);
      await page.mouse.down({ button });
      await page.mouse.move(middle[0] + 60, middle[1] + 20, { steps: 3 });
      await page.mouse.up({ button });
    };
    await drag("left");
    assert.ok(Math.hypot(...(await eye()).map((x, k) => x - home[k])) > 0.1);
    assert.notEqual(await state(page, "camera"), null);
    await page.keyboard.press("r");
    assert.equal(await state(page, "camera"), null);
    await drag("right");
    assert.ok(Math.hypot(...(await page.evaluate(() => hyperiso.view.controls.target.toArray()))) > 0.01);
    await page.keyboard.press("r");
    await page.mouse.move(...middle);
    await page.mouse.wheel(0, -300);
    await page.waitForFunction((far) => Math.hypot(...hyperiso.view.camera.position.toArray()) < far, Math.hypot(...home) * 0.99);
    await page.keyboard.press("r");
    await page.keyboard.press("+");
    assert.ok(Math.hypot(...(await eye())) < Math.hypot(...home));
  });

  test("clips by a plane and by a box", async () => {
    await reset();
    await openSection(page, "Clip");
    await page.uncheck("#axes");
    const { covered: all } = await picture(page);
    await page.selectOption("#clip-axis", { label: "across x" });
    const { covered: left } = await picture(page);
    assert.ok(left < 0.7 * all && left > 0);
    await page.check("#clip-flip");
    const { covered: right } = await picture(page);
    assert.ok(right < 0.7 * all && right > 0);
    await slide(page, "#clip-at", 0);
    near((await picture(page)).covered, all, 0);
    await page.selectOption("#clip-axis", "-1");
    await slide(page, "#box .span:nth-child(1) input:nth-of-type(1)", 0.5);
    const { covered: boxed } = await picture(page);
    assert.ok(boxed < 0.7 * all && boxed > 0);
    await slide(page, "#box .span:nth-child(1) input:nth-of-type(2)", 0.2);
    assert.deepEqual((await state(page, "box")).slice(0, 2), [0.2, 0.2]);
    await page.click("#clip-reset");
    assert.equal((await picture(page)).covered, all);
    await reset();
  });

  test("dark and light", async () => {
    await reset();
    assert.equal(await page.getAttribute("html", "data-theme"), "dark");
    await page.click("#theme");
    assert.equal(await page.getAttribute("html", "data-theme"), "light");
    await page.keyboard.press("d");
    assert.equal(await page.getAttribute("html", "data-theme"), "dark");
    await page.evaluate(() => hyperiso.set({ theme: "auto" }));
    await page.emulateMedia({ colorScheme: "light" });
    await page.waitForFunction(() => document.documentElement.dataset.theme === "light");
    await page.emulateMedia({ colorScheme: "dark" });
  });

  test("a click on the surface reads the point; beside it, nothing", async () => {
    await reset();
    await page.evaluate(() => hyperiso.moveTo(0.4));
    const centre = await clickSurface(page);
    const text = await page.evaluate(() => hyperiso.view.marker.text);
    assert.match(text, /^x = \S+ mm\ny = \S+ mm\nz = \S+ mm\nt = 0\.400 s\ncomponent 1 of 1\ndensity = 0\.5$/);
    const read = [...text.matchAll(/= (\S+) mm/g)].map((match) => Number(match[1]));
    centre.forEach((x, k) => near(read[k], x, 0.1));
    assert.equal(await page.textContent("#said"), text.replaceAll("\n", ", "));
    await page.click("#view", { position: { x: 30, y: 300 } });
    assert.equal(await page.evaluate(() => hyperiso.view.marker), null);
  });

  test("saves the picture, frames, and the slice as STL, PLY and GLB", async () => {
    await reset();
    await page.evaluate(() => hyperiso.moveTo(0.4)); // a step, where the plane runs through vertices
    await openSection(page, "Save");
    const saved = async (selector) => {
      const [download] = await Promise.all([page.waitForEvent("download"), page.click(selector)]);
      return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
    };
    const png = await saved("#save-png");
    assert.equal(png.name, "gaussians_t_0.400_s.png");
    assert.equal(png.bytes.toString("latin1", 1, 4), "PNG");
    const stl = (await saved("#save-stl")).bytes;
    const triangles = stl.readUInt32LE(80);
    assert.ok(triangles > 500 && triangles <= (await page.evaluate(() => hyperiso.slice().count)));
    assert.equal(stl.length, 84 + 50 * triangles);
    const ply = (await saved("#save-ply")).bytes;
    const header = ply.toString("latin1", 0, ply.indexOf("end_header"));
    const points = Number(header.match(/element vertex (\d+)/)[1]);
    assert.equal(Number(header.match(/element face (\d+)/)[1]), triangles);
    assert.equal(ply.length, header.length + 11 + 12 * points + 13 * triangles);
    // Welded: a closed surface of two balls has V - F/2 = 4.
    assert.equal(points - triangles / 2, 4);
    assert.ok(signedVolume(ply.subarray(header.length + 11), points, triangles) > 0, "faces inwards");
    const glb = (await saved("#save-glb")).bytes;
    assert.equal(glb.toString("latin1", 0, 4), "glTF");
    assert.equal(glb.readUInt32LE(8), glb.length);
    const json = JSON.parse(glb.toString("utf8", 20, 20 + glb.readUInt32LE(12)));
    assert.equal(json.accessors[1].count, 3 * triangles);
    assert.equal(json.accessors[0].count, points);
  });

  test("saves the frames of the whole run", async () => {
    const { page, problems, close } = await open("blobs.html", { width: 1000, height: 420 });
    await page.evaluate(() => hyperiso.moveTo(0.4));
    await openSection(page, "Save");
    const [download] = await Promise.all([page.waitForEvent("download"), page.click("#save-frames")]);
    const zip = readFileSync(await download.path());
    assert.equal(zip.readUInt16LE(zip.length - 12), 60);
    assert.match(zip.toString("latin1", 30, 60), /^gaussians_000\.png.PNG/);
    near(await position(page), 0.4);
    assert.deepEqual(problems, []);
    await close();
  });

  test("the address holds the state, and brings it back", async () => {
    await reset();
    await page.evaluate(() => {
      hyperiso.set({ colour: "axis:2", map: "magma", opacity: 0.6, clipAxis: 1, clipAt: 0.4, box: [0.1, 1, 0, 1, 0, 0.9], speed: 2, loop: "bounce", wireframe: true, theme: "light", projection: "orthographic" });
      hyperiso.turnTo([0.2, 0.1, 0, 1]);
      hyperiso.set({ offset: 0.1, camera: [2, -3, 1, 0, 0.1, 0] });
    });
    await openSection(page, "Save");
    await page.click("#copy-link");
    const hash = await page.evaluate(() => location.hash);
    const expected = await page.evaluate(() => JSON.stringify(hyperiso.state, (_, x) => (typeof x === "number" ? Number(x.toFixed(5)) : x)));
    const other = await open("blobs.html", { hash });
    const found = await other.page.evaluate(() => JSON.stringify(hyperiso.state, (_, x) => (typeof x === "number" ? Number(x.toFixed(5)) : x)));
    assert.deepEqual(JSON.parse(found), JSON.parse(expected));
    assert.deepEqual(other.problems, []);
    await other.close();
    const broken = await open("blobs.html", { hash: "#plane=1,2&at=nonsense&colour=no-such&opacity=&loop=x&box=1" });
    assert.equal(await broken.page.evaluate(() => JSON.stringify(hyperiso.state) === JSON.stringify(hyperiso.initial)), true);
    assert.deepEqual(broken.problems, []);
    await broken.close();
    await reset();
  });

  test("help lists the keys", async () => {
    await page.keyboard.press("?");
    assert.ok(await page.isVisible("#help"));
    assert.match(await page.textContent("#help"), /space.*play or pause/s);
    await page.keyboard.press("Escape");
    await page.click("#help-button");
    await page.click("#help button");
    assert.ok(await page.isHidden("#help"));
    const before = await state(page, "colour");
    await page.keyboard.press("c");
    assert.notEqual(await state(page, "colour"), before);
    await page.keyboard.press("a");
    assert.equal(await state(page, "axes"), false);
    await page.keyboard.press("w");
    assert.equal(await state(page, "wireframe"), true);
    for (const [key, axis, sign] of [["f", 1, -1], ["s", 0, 1], ["t", 2, 1]]) {
      await page.keyboard.press(key);
      assert.ok(sign * (await page.evaluate((axis) => hyperiso.view.camera.position.getComponent(axis), axis)) > 1);
    }
    const [download] = await Promise.all([page.waitForEvent("download"), page.keyboard.press("p")]);
    assert.match(download.suggestedFilename(), /\.png$/);
    await reset();
  });

  test("says so where the plane meets nothing", async () => {
    await page.evaluate(() => { hyperiso.acrossAxis(0); hyperiso.moveTo(-0.99); });
    assert.ok(await page.isVisible("#empty"));
    await reset();
    assert.ok(await page.isHidden("#empty"));
  });

  test("its file may be named by a path from here, with any signs", async () => {
    const file = join(folder, "100 % blobs #1.html");
    copyFileSync(join(folder, "blobs.html"), file);
    const { page, close } = await openPage(browser, relative(process.cwd(), file), { hash: "#at=0.5" });
    await ready(page);
    near(await position(page), 0.5);
    await close();
  });

  test("asked nothing of the network and had no errors", () => assert.deepEqual(problems, []));
});

function signedVolume(ply, points, faces) {
  const corner = (face, i) => {
    const number = ply.readInt32LE(12 * points + 13 * face + 1 + 4 * i);
    return [0, 1, 2].map((k) => ply.readFloatLE(12 * number + 4 * k));
  };
  let volume = 0;
  for (let face = 0; face < faces; ++face) {
    const [a, b, c] = [0, 1, 2].map((i) => corner(face, i));
    volume += a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return volume / 6;
}

describe("the page of a tracking result", () => {
  let page, problems, close;
  before(async () => { ({ page, problems, close } = await open("tracks.html")); });
  after(async () => { await close?.(); });

  const MERGE = 0.594922; // of these blobs on this grid

  test("shows tracks as lanes and events on the time line", async () => {
    assert.ok(await page.isVisible("#tracking"));
    assert.equal(await page.locator(".lane").count(), 2);
    const [glyph0] = await page.locator(".glyph").allTextContents();
    assert.match(glyph0, /^merge at t = 0\.59492 s: tracks 0, 1 → track [01]merge$/);
    assert.equal(await page.locator(".mark").count(), 1);
    assert.equal(await page.textContent(".tracking-head strong"), "2 tracks, 1 event");
    assert.deepEqual(await page.locator(".event-types button").allTextContents(), ["merge 1"]);
    assert.equal(await state(page, "colour"), "track");
    assert.match(await page.textContent("#legend"), /2 tracks/);
    // A mark stands where the slider's handle is at that time.
    const [mark, scrub] = [await page.locator(".mark").boundingBox(), await page.locator("#scrub").boundingBox()];
    near(mark.x + mark.width / 2, scrub.x + 8 + MERGE * (scrub.width - 16), 1);
    const glyph = await page.locator(".glyph path").boundingBox();
    near(glyph.x + glyph.width / 2, mark.x + mark.width / 2, 4);
  });

  test("each blob has its track until they merge into one", async () => {
    const wrong = await page.evaluate((merge) => {
      const { mesh, space } = hyperiso, tracks = hyperiso.trackOfVertex();
      // The blobs are mirror images: rounding decides which of them goes on.
      const after = hyperiso.metadata.tracking.tracks.find((track) => track.end_type === "open_end").id;
      let wrong = 0;
      for (let vertex = 0; vertex < mesh.vertexCount; ++vertex) {
        const [x, t] = [0, 3].map((k) => space.coordinate(k, mesh.levels[4 * vertex + k] * space.scale[k] + space.shift[k]));
        if (Math.abs(t - merge) > 0.05) wrong += tracks[vertex] !== (t > merge ? after : x > 0 ? 1 : 0);
      }
      return wrong;
    }, MERGE);
    assert.equal(wrong, 0);
  });

  test("a click on an event goes there, by mouse and by key", async () => {
    await page.click('[data-event="merge"]');
    near(await position(page), MERGE, 1e-5);
    assert.match(await page.evaluate(() => hyperiso.view.marker.text), /^merge\ntracks 0, 1 → track [01]\nt = 0\.59492 s$/);
    await page.keyboard.press("End");
    await page.keyboard.press("[");
    near(await position(page), MERGE, 1e-5);
    await page.keyboard.press("Home");
    assert.equal(await page.evaluate(() => hyperiso.view.marker), null);
    await page.keyboard.press("]");
    near(await position(page), MERGE, 1e-5);
    await page.keyboard.press("Home");
    await page.click(".mark");
    near(await position(page), MERGE, 1e-5);
    await page.keyboard.press("Home");
    await page.click("#event-back"); // there is none before
    near(await position(page), 0, 1e-5);
    await page.click("#event-forward");
    near(await position(page), MERGE, 1e-5);
    await page.keyboard.press("End");
    await page.click("#event-back");
    near(await position(page), MERGE, 1e-5);
    await page.click('#presets button:text-is("x")'); // where no event has a place: the first of all
    await page.click("#event-forward");
    near(await position(page), MERGE, 1e-5);
    assert.equal(await page.evaluate(() => hyperiso.axis), 3);
    await page.click('#presets button:text-is("x")');
    assert.equal(await page.locator(".mark").count(), 0);
    await page.focus('[data-event="merge"]');
    await page.keyboard.press("Enter");
    near(await position(page), MERGE, 1e-5);
    assert.equal(await page.evaluate(() => hyperiso.axis), 3);
  });

  test("says what happens at an event, to which tracks", async () => {
    const texts = await page.evaluate(() => [
      ["split", [0], [0, 1]], ["compound", [], [0, 1]], ["birth", [], [1], 2], ["exit", [1], [], -1], ["genus", [0], [0], -2],
      ["genus", [0], [0], 1], ["touch", [0], [0], -1], ["touch", [0], [0], 2],
    ].map(([type, from, to, delta_euler]) => {
      hyperiso.showEvent({ ...hyperiso.events[0], type, in: from, out: to, delta_euler });
      return hyperiso.view.marker.text;
    }));
    assert.deepEqual(texts, ["split\ntrack 0 → tracks 0, 1", "compound\nnothing → tracks 0, 1", "birth\ntrack 1 begins",
      "exit\ntrack 1 goes out through a wall", "genus\ntrack 0: a handle or a hole more", "genus\ntrack 0: a handle or a hole less",
      "touch\ntrack 0: walls cut it in one curve more", "touch\ntrack 0: walls cut it in 2 curves less"].map((text) => text + "\nt = 0.59492 s"));
  });

  test("what is said at an event does not lie under the legend", async () => {
    await page.selectOption("#colour", "track");
    const inked = await page.evaluate(() => {
      const legend = document.getElementById("legend"), { view } = hyperiso;
      const { offsetLeft: x, offsetTop: y, offsetWidth: width, offsetHeight: height } = legend;
      hyperiso.set({ axes: false });
      hyperiso.showEvent(hyperiso.events[0]);
      const ratio = view.renderer.getPixelRatio();
      const filled = (x, y) => {
        view.render();
        const { data } = document.getElementById("labels").getContext("2d").getImageData(x * ratio, y * ratio, width * ratio, height * ratio);
        return data.filter((alpha, i) => i % 4 === 3 && alpha > 200).length;
      };
      view.project = () => [x + 20, y + height / 2]; // wherever the event is, there
      const found = [filled(x, y), filled(x, y - height)];
      delete view.project;
      hyperiso.set({ axes: true });
      hyperiso.moveTo(0);
      return found;
    });
    assert.ok(inked[0] < 100 && inked[1] > 1000, inked.join()); // the circle that marks the place, and the text
  });

  test("hovering a track highlights it, whatever the surface is coloured by", async () => {
    await page.evaluate(() => hyperiso.moveTo(0.2));
    for (const colour of ["solid", "track", "component", "speed", "attribute:0", "axis:0"]) {
      await page.selectOption("#colour", colour);
      const plain = await picture(page);
      await page.hover('[data-track="1"]');
      assert.equal(await state(page, "highlight"), 1);
      assert.equal(await page.inputValue("#colour"), colour);
      const one = await picture(page);
      assert.notEqual(one.sum, plain.sum, colour);
      await page.hover('[data-track="0"]');
      const other = await picture(page);
      assert.ok(other.sum !== plain.sum && other.sum !== one.sum, colour);
      await page.mouse.move(300, 300);
      assert.equal(await state(page, "highlight"), -1);
      assert.equal((await picture(page)).sum, plain.sum, colour);
    }
  });

  test("scalars and labels of the mesh colour it", async () => {
    await page.selectOption("#colour", { label: "height" });
    const pictured = await picture(page);
    await page.selectOption("#colour", "axis:2");
    // The attribute is the third coordinate: over the same range, the same picture.
    const range = await page.evaluate(() => hyperiso.colourings.find((one) => one.name === "height").range);
    await page.evaluate((range) => hyperiso.set({ range }), range);
    (await picture(page)).mean.forEach((x, k) => near(x, pictured.mean[k], 1));
  });

  test("had no errors", () => assert.deepEqual(problems, []));
});

test("tracks of regions are told as such, and their events by what bodies are", async () => {
  const text = readFileSync(join(folder, "tracks.html"), "latin1");
  writeFileSync(join(folder, "regions.html"), text.replace('"regions":false', '"regions":true'), "latin1");
  const { page, problems, close } = await open("regions.html");
  assert.equal(await page.textContent(".tracking-head strong"), "2 tracks of regions, 1 event");
  assert.match(await page.textContent("#about-text"), /regions that the surface bounds/);
  const texts = await page.evaluate(() => [-1, 1].map((delta_euler) => {
    hyperiso.showEvent({ ...hyperiso.events[0], type: "genus", in: [0], out: [0], delta_euler });
    return hyperiso.view.marker.text.split("\n")[1];
  }));
  assert.deepEqual(texts, ["track 0: a tunnel more or a cavity less", "track 0: a tunnel less or a cavity more"]);
  assert.deepEqual(problems, []);
  await close();
});

describe("the events of a page", () => {
  // The page of two blobs with more events than they have.
  const TIMES = { touch: [0.1, 0.2, 0.3, 0.7], genus: [0.25], merge: [0.594922], birth: [0.45], death: [0.46] };
  let page, problems, close;
  before(async () => {
    const text = readFileSync(join(folder, "tracks.html"), "latin1");
    const many = text.replace(/(id="hyperiso-metadata">)(.*?)(<\/script>)/, (_, begin, json, end) => {
      const metadata = JSON.parse(json);
      const [merge] = metadata.tracking.events.filter((event) => event.type === "merge");
      for (const [type, times] of Object.entries(TIMES))
        if (type !== "merge") for (const time of times) metadata.tracking.events.push({ ...merge, type, time, in: [0], out: [0] });
      return begin + JSON.stringify(metadata) + end;
    });
    writeFileSync(join(folder, "events.html"), many, "latin1");
    ({ page, problems, close } = await open("events.html"));
  });
  after(async () => { await close?.(); });
  const button = (type) => page.locator(".event-types button", { hasText: type });
  const along = async (key) => {
    const found = [];
    await page.keyboard.press(key === "]" ? "Home" : "End");
    for (let i = 0; i < 9; ++i) {
      await page.keyboard.press(key);
      found.push(Number((await position(page)).toFixed(6)));
    }
    return [...new Set(found)];
  };
  const sorted = (...types) => types.flatMap((type) => TIMES[type]).sort((a, b) => a - b);

  test("are counted by type, and all are there at first", async () => {
    assert.deepEqual(await page.locator(".event-types button").allTextContents(), ["merge 1", "birth 1", "death 1", "genus 1", "touch 4"]);
    assert.equal(await page.textContent(".tracking-head strong"), "2 tracks, 8 events");
    assert.equal(await page.locator('.event-types [aria-pressed="true"]').count(), 5);
    await page.focus("#view");
    assert.deepEqual(await along("]"), sorted("merge", "birth", "death", "genus", "touch"));
  });

  test("are hidden by type: in the graph, on the time line, and on the way from one to the next", async () => {
    await button("touch").click();
    assert.equal(await button("touch").getAttribute("aria-pressed"), "false");
    assert.equal(await page.textContent(".tracking-head strong"), "2 tracks, 4 of 8 events");
    assert.equal(await page.locator('.glyph[data-event="touch"]').count(), 0);
    assert.equal(await page.locator(".glyph").count(), 4);
    assert.equal(await page.locator(".mark").count(), 4);
    await page.focus("#view");
    assert.deepEqual(await along("]"), sorted("merge", "birth", "death", "genus"));
    assert.deepEqual(await along("["), sorted("merge", "birth", "death", "genus").reverse());
    await button("genus").focus();
    await page.keyboard.press(" "); // by the keyboard, and nothing plays
    assert.equal(await state(page, "playing"), false);
    assert.equal(await state(page, "hide"), "genus,touch");
    assert.equal(await page.locator(".mark").count(), 3);
  });

  test("do not stand between the keyboard and the time line", async () => {
    await page.focus(".lane >> nth=-1");
    await page.keyboard.press("Tab");
    assert.equal(await page.evaluate(() => document.activeElement.id), "step-back");
    await page.keyboard.press("]");
    assert.match(await page.textContent("#said"), /^(merge|birth|death), .*, t = 0\.\d+ s$/);
  });

  test("stay hidden in the address of the page", async () => {
    await page.waitForFunction(() => location.hash.includes("hide="));
    const hash = await page.evaluate(() => location.hash);
    const other = await open("events.html", { hash });
    assert.equal(await other.page.locator('.event-types [aria-pressed="false"]').count(), 2);
    assert.equal(await other.page.locator(".glyph").count(), 3);
    await other.close();
    const unknown = await open("events.html", { hash: "#hide=no-such,touch" });
    assert.equal(await state(unknown.page, "hide"), "touch");
    await unknown.close();
  });

  test("may all be hidden, and come back", async () => {
    for (const type of ["merge", "birth", "death"]) await button(type).click();
    assert.equal(await page.locator(".glyph, .mark").count(), 0);
    assert.ok(await page.isDisabled("#event-forward"));
    for (const type of Object.keys(TIMES)) await button(type).click();
    assert.equal(await page.locator(".glyph").count(), 8);
    assert.equal(await state(page, "hide"), "");
    assert.equal(await page.locator(".link").count(), 1);
  });

  test("are named beside their glyph, and tracks in their lanes, where that hides nothing", async () => {
    const overlaps = await page.evaluate(() => {
      const boxes = [...document.querySelectorAll(".glyph")].flatMap((glyph) => [...glyph.querySelectorAll("text, path, circle, rect")].map((one) => ({ glyph, box: one.getBoundingClientRect() })));
      for (const text of document.querySelectorAll(".lane text")) boxes.push({ glyph: text.closest(".lane"), box: text.getBoundingClientRect() });
      const names = boxes.filter(({ glyph, box }) => glyph.querySelector("text")?.getBoundingClientRect().left === box.left);
      return [names.length, names.flatMap(({ glyph, box }) => boxes.filter((other) => other.glyph !== glyph && other.box.top < box.bottom && other.box.bottom > box.top &&
        other.box.left < box.right && other.box.right > box.left).map((other) => `${glyph.dataset.event} over ${other.glyph.dataset.event}`))];
    });
    assert.ok(overlaps[0] >= 3, String(overlaps[0]));
    assert.deepEqual(overlaps[1], []);
  });

  test("had no errors", () => assert.deepEqual(problems, []));
});

describe("surfaces in three dimensions", () => {
  test("two of space and one of time: the curve of a moment on the surface of all of them", async () => {
    const { page, problems, close } = await open("spacetime.html");
    assert.match(await page.textContent("#position"), /^t = 0\.000 s/);
    const masks = await page.evaluate(() => probe.compareMasks());
    assert.ok(masks.gpu > 1000 && masks.differing <= 2, JSON.stringify(masks));
    await page.evaluate(() => hyperiso.moveTo(0.5));
    const half = await picture(page);
    await page.check("#hide-beyond");
    assert.ok((await picture(page)).covered < half.covered);
    await page.click('[data-event="merge"]'); // which is marked on the surface, at its time
    const [height, time, away] = await page.evaluate(() => {
      const { space, view: { marker: { point } }, events: [{ time }] } = hyperiso, { positions: p, count } = hyperiso.slice();
      let away = Infinity;
      for (let at = 0; at < 9 * count; at += 3) away = Math.min(away, Math.hypot(p[at] - point.x, p[at + 1] - point.y, p[at + 2] - point.z));
      return [point.z, space.scene(2, time), away];
    });
    near(height, time, 1e-6);
    assert.ok(away < 0.1, String(away));
    await page.click('#presets button:text-is("oblique")');
    assert.equal(await page.evaluate(() => hyperiso.axis), -1);
    assert.deepEqual(problems, []);
    await close();
  });

  test("a still one", async () => {
    const { page, problems, close } = await open("still.html");
    const masks = await page.evaluate(() => probe.compareMasks());
    assert.ok(masks.gpu > 1000 && masks.differing <= 2, JSON.stringify(masks));
    const options = await page.$$eval("#colour option", (list) => list.map((one) => one.value));
    assert.deepEqual(options, ["solid", "component", "axis:0", "axis:1", "axis:2"]);
    assert.deepEqual(problems, []);
    await close();
  });

  test("an empty one", async () => {
    const { page, problems, close } = await open("empty.html");
    assert.ok(await page.isVisible("#empty"));
    assert.deepEqual(problems, []);
    await close();
  });
});

describe("the page of an interval volume", () => {
  test("slides between the isovalues: balls of the radii that they have", async () => {
    const { page, problems, close } = await open("levels.html");
    assert.match(await page.textContent("#position"), /^isovalue = 0\.4\d* *level 1 of 2$/);
    assert.equal(await page.textContent("#slice-hint"), "One isovalue. Play moves through them.");
    assert.equal(await page.textContent("#subtitle"), "isovalues 0.2 to 0.6");
    const first = await page.locator("#presets button").first().textContent();
    assert.equal(first, "isovalue");
    for (const isovalue of [0.2, 0.3, 0.4, 0.52, 0.6]) {
      await slide(page, "#scrub", isovalue);
      near((await page.evaluate(() => probe.area())) / (4 * Math.PI * (1 - isovalue) ** 2), 1, 0.02);
      const masks = await page.evaluate(() => probe.compareMasks());
      assert.ok(masks.gpu > 1000 && masks.differing <= 2, JSON.stringify(masks));
    }
    await page.focus("#view");
    await page.keyboard.press("Home");
    near(await position(page), 0.2);
    await page.keyboard.press("ArrowRight");
    near(await position(page), 0.4);
    await page.click("#play");
    await page.waitForFunction(() => hyperiso.toPosition(hyperiso.state.offset) > 0.41);
    await page.click("#play");
    await page.selectOption("#colour", "axis:3");
    assert.match(await page.textContent("#legend"), /isovalue/);
    assert.deepEqual(problems, []);
    await close();
  });

  test("shows the outside of the ball lit, not its inside", async () => {
    const { page, close } = await open("levels.html");
    // Of the normals, those of the surface point away from the middle.
    const wrong = await page.evaluate(() => {
      hyperiso.moveTo(0.45);
      const { positions: p, count } = hyperiso.slice();
      const normals = hyperiso.slice().normals;
      let wrong = 0;
      for (let at = 0; at < 9 * count; at += 9) wrong += p[at] * normals[at] + p[at + 1] * normals[at + 1] + p[at + 2] * normals[at + 2] < 0;
      return wrong / count;
    });
    assert.equal(wrong, 0);
    await close();
  });
});

describe("what goes wrong is said", () => {
  const whole = () => readFileSync(join(folder, "blobs.html"), "latin1");
  const failure = async (name, content, prepare) => {
    const file = join(folder, name);
    writeFileSync(file, content, "latin1");
    const context = await browser.newContext();
    const page = await context.newPage();
    if (prepare) await page.addInitScript(prepare);
    await page.goto(`file://${file}`);
    await page.waitForSelector("#loading.failed", { timeout: PATIENCE });
    const text = await page.textContent("#loading-text");
    await context.close();
    return text;
  };

  test("a file that is cut short", async () => {
    const page = whole();
    const text = await failure("cut.html", page.slice(0, page.lastIndexOf('<script type="text/plain"')));
    assert.match(text, /part \d+ of \d+ of the data is missing: the file is cut short/);
  });
  test("damaged data", async () => {
    const page = whole();
    const at = page.lastIndexOf('class="hyperiso-block">') + 400;
    assert.match(await failure("damaged.html", page.slice(0, at) + "AAAAAAAA" + page.slice(at + 8)), /of the data/);
  });
  test("damaged description", async () => {
    assert.match(await failure("description.html", whole().replace('{"format":1', '{"format":1,,')), /the description of the data is damaged/);
  });
  test("another format", async () => {
    assert.match(await failure("format.html", whole().replace('{"format":1', '{"format":99')), /format 99/);
  });
  test("no data", async () => {
    const page = whole();
    assert.match(await failure("none.html", page.slice(0, page.indexOf('<script type="application/json"'))), /holds no data/);
  });
  test("no WebGL 2", async () => {
    const text = await failure("no-webgl.html", whole(), () => {
      HTMLCanvasElement.prototype.getContext = () => null;
    });
    assert.match(text, /no WebGL 2/);
  });
  test("more than the graphics card holds", async () => {
    const text = await failure("huge.html", whole(), () => {
      const original = WebGL2RenderingContext.prototype.getParameter;
      WebGL2RenderingContext.prototype.getParameter = function (name) {
        return name === this.MAX_TEXTURE_SIZE ? 2 : original.call(this, name);
      };
    });
    assert.match(text, /holds 4,096 simplices, the surface has/);
  });
});

describe("on a phone", () => {
  // The name of a file is the title where no other is given, and has no place to break.
  for (const width of [320, 390, 1200])
    test(`a long title at ${width} pixels leaves the buttons where they are`, async () => {
      const { page, close } = await open("blobs.html", { width, height: 720 });
      const places = () => page.evaluate(() => [...document.querySelectorAll(".corner button")].map((one) => one.getBoundingClientRect().right));
      const before = await places();
      await page.evaluate(() => (document.getElementById("title").textContent = "alpha_water_24x24x24x41_".repeat(9)));
      assert.deepEqual(await places(), before);
      assert.ok(before.every((right) => right <= width), before.join());
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
      const bottom = await page.evaluate(() => document.getElementById("title").getBoundingClientRect().height);
      assert.ok(bottom < 60, String(bottom));
      await close();
    });
  for (const width of [320, 390])
    test(`${width} pixels wide: nothing is cut off, controls open and close`, async () => {
      const { page, problems, close } = await open("tracks.html", { width, height: 720, touch: true });
      assert.deepEqual(await page.evaluate(() => [...document.querySelectorAll("body *:not(#panel *)")].filter((one) => one.getBoundingClientRect().right > innerWidth + 0.5).map((one) => one.id || one.className)), []);
      for (const selector of ["#play", "#scrub", "#position", "#speed", "#panel-button"]) {
        const box = await page.locator(selector).boundingBox();
        assert.ok(box && box.x >= 0 && box.x + box.width <= width, selector);
        assert.ok(box.height >= 28, selector);
      }
      // What an event is said to be stands whole in the picture.
      const edges = await page.evaluate(() => {
        hyperiso.showEvent({ ...hyperiso.events[0], type: "touch" });
        hyperiso.view.render();
        const labels = document.getElementById("labels"), context = labels.getContext("2d");
        const filled = (x) => context.getImageData(x, 0, 1, labels.height).data.filter((value, i) => i % 4 === 3 && value > 200).length;
        return [filled(0), filled(labels.width - 1), filled(labels.width >> 1)];
      });
      assert.deepEqual(edges.slice(0, 2), [0, 0]);
      assert.ok(edges[2] > 30, edges.join());
      assert.ok(await page.isHidden("#panel"));
      await openPanel(page);
      await page.selectOption("#colour", "axis:0");
      assert.equal(await state(page, "colour"), "axis:0");
      const panel = await page.locator("#panel").boundingBox();
      assert.ok(panel.x >= 0 && panel.x + panel.width <= width);
      assert.ok(await page.evaluate(() => {
        const panel = document.getElementById("panel");
        for (const one of panel.querySelectorAll("details")) one.open = true;
        return panel.scrollWidth <= panel.clientWidth;
      }));
      await page.touchscreen.tap(100, 100);
      await page.waitForSelector("#panel", { state: "hidden" });
      assert.deepEqual(problems, []);
      await close();
    });

  for (const [width, height] of [[568, 320], [844, 390]])
    for (const name of ["tracks.html", "blobs.html"])
      test(`on its side, ${width} by ${height} pixels, ${name}: picture and controls both have room`, async () => {
        const { page, problems, close } = await open(name, { width, height, touch: true });
        const box = (selector) => page.locator(selector).boundingBox();
        const stage = await box("#stage");
        assert.ok(stage.width >= 0.48 * width && stage.height >= 240, JSON.stringify(stage));
        const controls = ["#play", "#step-back", "#step-forward", "#scrub", "#position", "#speed", "#loop", "#panel-button", "#help-button"];
        if (name === "tracks.html") controls.push("#event-back", "#event-forward", ".event-types button", ".lane");
        for (const selector of controls) {
          const { x, y, width: w, height: h } = await page.locator(selector).first().boundingBox();
          assert.ok(x >= 0 && y >= 0 && x + w <= width + 0.5 && y + h <= height + 0.5, `${selector}: ${[x, y, w, h]}`);
        }
        assert.ok((await box("#scrub")).width >= 80);
        await page.evaluate(() => {
          document.getElementById("title").textContent = "alpha_water_24x24x24x41";
          document.getElementById("subtitle").textContent = "how much water there is · isovalue 0.5";
          hyperiso.set({ colour: "time" });
        });
        const [heading, legend] = [await box("#subtitle"), await box("#legend")];
        assert.ok(heading.y + heading.height <= legend.y, JSON.stringify([heading, legend]));
        await page.tap("#help-button");
        assert.equal(await page.$eval("#help", (help) => help.scrollTop), 0); // it begins with its beginning
        await page.keyboard.press("Escape");
        const text = await page.evaluate(() => { const one = document.getElementById("position"); return [one.scrollWidth, one.clientWidth]; });
        assert.ok(text[0] <= text[1], text.join());
        await openPanel(page);
        const panel = await box("#panel");
        assert.ok(panel.x >= 0.35 * width && panel.height === height, JSON.stringify(panel)); // the picture is still there
        await page.selectOption("#colour", "axis:0");
        await page.touchscreen.tap(100, 200);
        await page.waitForSelector("#panel", { state: "hidden" });
        assert.deepEqual(problems, []);
        await close();
      });

  test("one finger turns", async () => {
    const { page, close } = await open("blobs.html", { width: 390, height: 720, touch: true });
    const before = await page.evaluate(() => hyperiso.view.camera.position.toArray());
    const session = await page.context().newCDPSession(page);
    const touch = (type, x) => session.send("Input.dispatchTouchEvent", { type, touchPoints: type === "touchEnd" ? [] : [{ x, y: 200 }] });
    await touch("touchStart", 150);
    await touch("touchMove", 180);
    await touch("touchMove", 240);
    await touch("touchEnd", 240);
    const after = await page.evaluate(() => hyperiso.view.camera.position.toArray());
    assert.ok(Math.hypot(...after.map((x, k) => x - before[k])) > 0.1);
    await close();
  });
});

const fieldPages = existsSync(join(folder, "exact_field.html"));
describe("pages that extract", { skip: fieldPages ? false : "built without the extraction core" }, () => {
  const arrays = (page) => page.evaluate(async () => {
    const sum = async (array) => [...new Uint8Array(await crypto.subtle.digest("SHA-256", array))].join();
    const { mesh } = hyperiso;
    return { vertices: mesh.vertexCount, simplices: mesh.simplexCount, levels: await sum(mesh.levels), corners: await sum(mesh.simplices),
      normals: await sum(mesh.normals), boxes: await sum(mesh.boxes), attributes: await Promise.all(mesh.attributes.map(sum)) };
  });
  const silhouette = (page) => page.evaluate(() => [0, 0.333, 0.6, 1].map((time) => {
    hyperiso.moveTo(time);
    return probe.picture().sum;
  }));
  const settled = (page, isovalue) => page.waitForFunction((isovalue) => hyperiso.shownIsovalue === isovalue &&
    document.getElementById("isovalue-progress").style.visibility === "hidden", isovalue);

  test("the surface, a band and the whole field give the same arrays and the same pixels", async () => {
    const found = [];
    for (const kind of ["mesh", "band", "field"]) {
      const { page, problems, close } = await open(`exact_${kind}.html`);
      found.push([await arrays(page), await silhouette(page)]);
      assert.deepEqual(problems, []);
      await close();
    }
    assert.ok(found[0][0].simplices > 10_000);
    assert.deepEqual(found[1], found[0]);
    assert.deepEqual(found[2], found[0]);
  });

  test("in world coordinates too, with times and places of events", async () => {
    const found = [];
    for (const kind of ["mesh", "band", "field"]) {
      const { page, problems, close } = await open(`turned_${kind}.html`);
      found.push([await arrays(page), await page.evaluate(() => hyperiso.space.axes), await page.evaluate(() => hyperiso.metadata.tracking)]);
      assert.match(await page.textContent("#position"), /^t = 7\.0+ sstep 0 of 20$/);
      await page.click('[data-event="merge"]');
      near(await position(page), 7 + 0.5 * 0.595, 0.01);
      // It is marked where the blobs meet: on the surface.
      const away = await page.evaluate(() => {
        const { x, y, z } = hyperiso.view.marker.point, { positions: p, count } = hyperiso.slice();
        let least = Infinity;
        for (let at = 0; at < 9 * count; at += 3) least = Math.min(least, Math.hypot(p[at] - x, p[at + 1] - y, p[at + 2] - z));
        return least;
      });
      assert.ok(away < 0.1, `${away} away`);
      await page.keyboard.press("Home");
      const area = await page.evaluate(() => probe.area());
      assert.ok(area > 0.1, String(area));
      assert.deepEqual(problems, []);
      await close();
    }
    assert.deepEqual(found[1], found[0]);
    assert.deepEqual(found[2], found[0]);
  });

  test("of rounded samples as well, but for rounding", async () => {
    const found = [];
    for (const kind of ["mesh", "band", "field"]) {
      const { page, problems, close } = await open(`rounded_${kind}.html`);
      const { vertices, simplices, attributes } = await arrays(page);
      const pixels = await page.evaluate(() => [0, 0.333, 0.6, 1].map((time) => {
        hyperiso.moveTo(time);
        return [probe.compareMasks().gpu, probe.area()];
      }));
      found.push({ counts: [vertices, simplices, attributes], pixels });
      assert.deepEqual(problems, []);
      await close();
    }
    for (const other of [found[1], found[2]]) {
      assert.deepEqual(other.counts, found[0].counts);
      other.pixels.flat().forEach((x, i) => near(x / found[0].pixels.flat()[i], 1, 1e-3));
    }
  });

  test("only the page of the whole field has a slider", async () => {
    for (const [kind, shown] of [["mesh", false], ["band", false], ["field", true]]) {
      const { page, close } = await open(`exact_${kind}.html`);
      assert.equal(await page.isVisible("#isovalue"), shown, kind);
      await close();
    }
  });

  test("the slider, the number, the keys and the button choose the surface; the address keeps it", async () => {
    const { page, problems, close } = await open("exact_field.html");
    const own = await arrays(page);
    const area = () => page.evaluate(() => probe.area());
    assert.equal(await page.inputValue("#isovalue-number"), "127.5");
    assert.ok(await page.isDisabled("#isovalue-back"));
    assert.ok((await page.locator("#histogram path").first().getAttribute("d")).length > 200);
    const before = await area();

    await slide(page, "#isovalue", 191.25);
    await settled(page, 191.25);
    // exp(-r^2 / 0.08) is 0.75 instead of 0.5
    near((await area()) / before, Math.log(4 / 3) / Math.log(2), 0.05);
    assert.match(await page.textContent("#subtitle"), /isovalue 191.25/);
    assert.match(await page.textContent("#about-text"), /at 191.25/);
    const masks = await page.evaluate(() => { hyperiso.moveTo(0.4); return probe.compareMasks(); });
    assert.ok(masks.gpu > 200 && masks.differing <= 2, JSON.stringify(masks));

    await page.fill("#isovalue-number", "60");
    await page.press("#isovalue-number", "Enter");
    await settled(page, 60);
    const sixty = await arrays(page);
    await clickSurface(page);
    assert.match(await page.evaluate(() => hyperiso.view.marker.text), /density = 60$/);
    await page.waitForFunction(() => location.hash.includes("isovalue=60"));
    const address = await page.evaluate(() => location.hash);

    await page.focus("#isovalue");
    await page.keyboard.press("ArrowRight");
    const next = await state(page, "isovalue");
    assert.ok(next > 60 && next < 70, next);
    await settled(page, next);

    await page.fill("#isovalue-number", "1e9"); // beyond the samples
    await page.press("#isovalue-number", "Enter");
    const end = await state(page, "isovalue");
    assert.ok(end <= 255);
    await settled(page, end);
    await page.click("#isovalue-back");
    await settled(page, 127.5);
    assert.deepEqual(await arrays(page), own);
    assert.ok(await page.isDisabled("#isovalue-back"));
    assert.deepEqual(problems, []);
    await close();

    const again = await open("exact_field.html", { hash: address });
    await settled(again.page, 60);
    assert.deepEqual(await arrays(again.page), sixty);
    await again.close();
    const mesh = await open("exact_60.html");
    assert.deepEqual({ ...(await arrays(mesh.page)), attributes: [] }, { ...sixty, attributes: [] });
    await mesh.close();
  });

  test("an isovalue that no sample reaches is told as it is", async () => {
    for (const kind of ["mesh", "band", "field"]) {
      const { page, problems, close } = await open(`beyond_${kind}.html`);
      assert.equal(await page.textContent("#subtitle"), "density · isovalue 300");
      assert.equal(await page.textContent("#empty"), "There is no surface at isovalue 300.");
      if (kind === "field") {
        assert.deepEqual([await page.inputValue("#isovalue-number"), await page.inputValue("#isovalue")], ["300", "255"]);
        await slide(page, "#isovalue", 127.5);
        await settled(page, 127.5);
        assert.ok(await page.isHidden("#empty"));
        await page.click("#isovalue-back");
        await settled(page, 300);
        assert.ok(await page.isVisible("#empty"));
      }
      assert.deepEqual(problems, []);
      await close();
    }
  });

  test("the page goes on while a surface is extracted, and the latest isovalue wins", async () => {
    const { page, close } = await open("exact_field.html");
    const shown = await page.evaluate(async () => {
      const shown = [];
      hyperiso.onMesh(() => shown.push(hyperiso.shownIsovalue));
      for (const isovalue of [50, 60, 70, 80, 90]) hyperiso.set({ isovalue });
      hyperiso.moveTo(0.5); // at once, with the surface there is
      const visible = document.getElementById("isovalue-progress").style.visibility;
      while (shown.at(-1) !== 90) await new Promise((resolve) => setTimeout(resolve, 10));
      return { shown, visible };
    });
    assert.equal(shown.visible, "visible");
    assert.ok(shown.shown.length <= 2, shown.shown.join()); // the first, which had begun, and the last
    await close();
  });

  test("tracks stay with their isovalue, and the page says so", async () => {
    const { page, close } = await open("exact_field.html");
    assert.equal(await state(page, "colour"), "track");
    assert.ok(await page.isHidden(".stale"));
    const coloured = await page.evaluate(() => probe.picture().mean);
    await page.evaluate(() => hyperiso.set({ isovalue: 100 }));
    await settled(page, 100);
    assert.ok(await page.isVisible(".stale"));
    assert.match(await page.textContent(".stale"), /isovalue 127.5/);
    assert.equal(await page.locator(".mark").count(), 0);
    assert.ok(await page.evaluate(() => document.querySelector('#colour option[value="track"]').disabled));
    assert.ok(await page.isHidden("#legend"));
    await page.evaluate(() => hyperiso.stepEvent(1));
    near(await position(page), 0);
    await page.selectOption("#colour", "component"); // belongs to any surface
    assert.match(await page.textContent("#legend"), /2 components|1 component/);
    await page.evaluate(() => hyperiso.set({ colour: "track" }));
    await page.click(".stale button");
    await settled(page, 127.5);
    assert.ok(await page.isHidden(".stale"));
    assert.equal(await page.locator(".mark").count(), 1);
    assert.deepEqual(await page.evaluate(() => probe.picture().mean), coloured);
    await close();
  });

  test("damaged samples are told", async () => {
    const text = readFileSync(join(folder, "exact_field.html"), "latin1");
    const broken = join(folder, "broken_field.html");
    for (const [change, expected] of [
      [(page) => page.replace(/"blocks":\[21\]/, '"blocks":[20]'), /samples is damaged|part/],
      [(page) => page.replace(/"simplices":\d+/, '"simplices":7'), /another than the one/],
    ]) {
      writeFileSync(broken, change(text), "latin1");
      assert.notEqual(change(text), text);
      const context = await browser.newContext();
      const page = await context.newPage();
      await page.goto(`file://${broken}`);
      await page.waitForSelector("#loading.failed", { timeout: PATIENCE });
      assert.match(await page.textContent("#loading-text"), expected);
      await context.close();
    }
  });
});
