import { runnerImport } from "vite";

await runnerImport(new URL("./shots.ts", import.meta.url).pathname);
process.exit(0);
