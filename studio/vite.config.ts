import { defineConfig } from "vitest/config";

// Relative asset paths: the local server may serve the page from any folder.
export default defineConfig({
  base: "./",
  build: { target: "es2022", chunkSizeWarningLimit: 1200 },
  test: { include: ["test/**/*.test.ts"] },
});
