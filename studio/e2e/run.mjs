/** Runs the browser tests on the built page, or says loudly that it cannot. */

import { spawnSync } from "node:child_process";
import { fileURLToPath } from "node:url";
import { runnerImport } from "vite";

const root = fileURLToPath(new URL("..", import.meta.url));
const { module } = await runnerImport(`${root}e2e/browser.ts`);
if (!module.findChrome()) {
  console.log(
    "\n==== SKIPPED: no Chrome or Chromium found ====\nSet CHROME to its program to run the browser tests.\n",
  );
  process.exit(process.env.CI === "true" ? 1 : 0);
}
const steps = [
  ["vite", "build", "--logLevel", "warn"],
  ["vitest", "run", "--config", "e2e/vitest.config.ts"],
];
for (const [program, ...args] of steps) {
  const { status } = spawnSync(`${root}node_modules/.bin/${program}`, args, { cwd: root, stdio: "inherit" });
  if (status !== 0) process.exit(status ?? 1);
}
