/** A tiny static server on the loopback: the built page, and crowds from memory. */

import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import type { AddressInfo } from "node:net";
import { extname, join, normalize } from "node:path";

const TYPES: Record<string, string> = {
  ".html": "text/html",
  ".js": "text/javascript",
  ".css": "text/css",
  ".woff2": "font/woff2",
  ".json": "application/json",
};

export interface Server {
  url: string;
  /** What is under /data/. */
  data: Map<string, Uint8Array>;
  close: () => Promise<void>;
}

export async function serve(folder: string): Promise<Server> {
  const data = new Map<string, Uint8Array>();
  const server = createServer(async (request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url ?? "/", "http://x").pathname));
    const body = path.startsWith("/data/")
      ? data.get(path.slice(6))
      : await readFile(join(folder, path === "/" ? "index.html" : path)).catch(() => undefined);
    if (!body) {
      response.writeHead(404).end();
      return;
    }
    const name = path === "/" ? ".html" : extname(path);
    response.writeHead(200, { "content-type": TYPES[name] ?? "application/octet-stream" }).end(body);
  });
  await new Promise<void>((done) => server.listen(0, "127.0.0.1", done));
  const { port } = server.address() as AddressInfo;
  const close = () => new Promise<void>((done) => server.close(() => done()));
  return { url: `http://127.0.0.1:${port}`, data, close };
}
