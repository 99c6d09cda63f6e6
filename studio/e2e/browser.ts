/** An installed Chrome or Chromium, driven without a display or a graphics card. */

import { existsSync } from "node:fs";
import { delimiter, join } from "node:path";
import { type Browser, chromium } from "playwright-core";

/** The browser's program: $CHROME, or one of the usual names; null if there is none. */
export function findChrome(): string | null {
  const { CHROME, PATH = "" } = process.env;
  if (CHROME) return existsSync(CHROME) ? CHROME : null;
  const names = ["google-chrome", "google-chrome-stable", "chromium", "chromium-browser"];
  const found = PATH.split(delimiter).flatMap((folder) => names.map((name) => join(folder, name)));
  return ["/usr/bin/chromium", ...found].find((path) => existsSync(path)) ?? null;
}

export function launch(program: string): Promise<Browser> {
  return chromium.launch({
    executablePath: program,
    // Playwright's own switch for headless turns the GPU process off, which SwiftShader needs.
    ignoreDefaultArgs: ["--disable-gpu"],
    args: [
      "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader",
      "--no-sandbox",
      "--headless=new",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
    ],
  });
}
