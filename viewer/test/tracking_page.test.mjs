// Tracks and events on a page.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { folder, near, open, picture, position, state } from "./page_case.mjs";

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
    await page.waitForFunction(() => location.hash.includes("hide=") && location.href === hyperiso.link());
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
