import { defineConfig } from "vitest/config";

// One browser, one page after the other: pictures on a CPU are slow enough alone.
export default defineConfig({
  test: {
    include: ["e2e/**/*.e2e.ts"],
    root: new URL("..", import.meta.url).pathname,
    fileParallelism: false,
    testTimeout: 240_000,
    hookTimeout: 120_000,
  },
});
