// Pages that extract their surface from samples, and let the isovalue be chosen.
import assert from "node:assert/strict";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { before, describe, test } from "node:test";
import { PATIENCE } from "./browser.mjs";
import { browser, clickSurface, folder, near, open, position, slide, state } from "./page_case.mjs";

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

  /// What `look` finds in the page of the surface, of a band and of the whole field.
  const inAllKinds = async (name, look) => {
    const found = [];
    for (const kind of ["mesh", "band", "field"]) {
      const { page, problems, close } = await open(`${name}_${kind}.html`);
      found.push(await look(page));
      assert.deepEqual(problems, []);
      await close();
    }
    return found;
  };

  test("the surface, a band and the whole field give the same arrays and the same pixels", async () => {
    const found = await inAllKinds("exact", async (page) => [await arrays(page), await silhouette(page)]);
    assert.ok(found[0][0].simplices > 10_000);
    assert.deepEqual(found[1], found[0]);
    assert.deepEqual(found[2], found[0]);
  });

  test("in world coordinates too, with times and places of events", async () => {
    const found = await inAllKinds("turned", async (page) => {
      const seen = [await arrays(page), await page.evaluate(() => hyperiso.space.axes), await page.evaluate(() => hyperiso.metadata.tracking)];
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
      return seen;
    });
    assert.deepEqual(found[1], found[0]);
    assert.deepEqual(found[2], found[0]);
  });

  test("of rounded samples as well, but for rounding", async () => {
    const found = await inAllKinds("rounded", async (page) => {
      const { vertices, simplices, attributes } = await arrays(page);
      const pixels = await page.evaluate(() => [0, 0.333, 0.6, 1].map((time) => {
        hyperiso.moveTo(time);
        return [probe.compareMasks().gpu, probe.area()];
      }));
      return { counts: [vertices, simplices, attributes], pixels };
    });
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
