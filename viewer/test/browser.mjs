// Debian's Chromium with WebGL 2 drawn by software, driven by playwright-core.
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

/// How long is waited for what must come, in milliseconds: on a busy machine it takes its time.
export const PATIENCE = 180_000;

export async function openBrowser() {
  return chromium.launch({
    timeout: PATIENCE,
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
      "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
  });
}

/// Opens a page file, wherever its path starts; `problems` collects what must not happen: console errors, requests to anywhere.
export async function openPage(browser, file, { width = 1040, height = 660, colorScheme = "dark", hash = "", scale = 1, touch = false } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme, deviceScaleFactor: scale, hasTouch: touch, acceptDownloads: true });
  context.setDefaultTimeout(PATIENCE);
  const page = await context.newPage();
  const problems = [];
  page.on("console", (message) => {
    if (message.text().includes("Multiple instances of Three.js")) return; // test/probe.ts brings its own
    if (message.type() === "error" || /WebGL|GL ERROR|THREE/.test(message.text())) problems.push(message.text());
  });
  page.on("pageerror", (error) => problems.push(String(error)));
  page.on("request", (request) => {
    if (!/^(file:|data:|blob:)/.test(request.url())) problems.push(`request to ${request.url()}`);
  });
  await page.goto(pathToFileURL(resolve(file)).href + hash);
  return { page, problems, close: () => context.close() };
}

export const ready = (page) => page.waitForFunction(() => document.documentElement.dataset.ready === "true");
