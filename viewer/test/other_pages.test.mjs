// Surfaces in three dimensions and interval volumes, files that are damaged, and small screens.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { PATIENCE } from "./browser.mjs";
import { browser, folder, near, open, openPanel, picture, position, slide, state } from "./page_case.mjs";

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
