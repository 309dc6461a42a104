// What a reader finds on the page of a surface in space and time: each control is used and what it changes is
// asserted.
import assert from "node:assert/strict";
import { copyFileSync, readFileSync } from "node:fs";
import { join, relative } from "node:path";
import { after, before, describe, test } from "node:test";
import { openPage, ready } from "./browser.mjs";
import { browser, clickSurface, folder, frames, here, near, open, openSection, picture, position, slide, state } from "./page_case.mjs";

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
