/** The built page for a file of tests: one server and one browser, a fresh tab for every test. */

import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, beforeEach } from "vitest";
import { findChrome, launch } from "./browser";
import { type Server, serve } from "./server";

export class Site {
  server!: Server;
  page!: Page;
  /** Errors and warnings of the page. */
  complaints: string[] = [];
  private browser!: Browser;

  /** Serves `files` under /data/. */
  constructor(files: Record<string, Uint8Array>) {
    beforeAll(async () => {
      this.server = await serve("dist");
      for (const [name, bytes] of Object.entries(files)) this.server.data.set(name, bytes);
      this.browser = await launch(findChrome() as string);
    });
    afterAll(async () => {
      await this.browser?.close();
      await this.server?.close();
    });
    beforeEach(() => this.freshTab());
  }

  private async freshTab(): Promise<void> {
    await this.page?.close();
    this.page = await this.browser.newPage({ viewport: { width: 1100, height: 700 } });
    this.complaints = [];
    this.page.on("console", (message) => {
      const complaint = ["error", "warning"].includes(message.type()) && !/GPU stall/.test(message.text());
      if (complaint) this.complaints.push(message.text());
    });
    this.page.on("pageerror", (error) => this.complaints.push(error.message));
  }

  /** Opens the page and waits for its first picture. */
  readonly open = async (query: string): Promise<void> => {
    await this.page.goto(`${this.server.url}/?${query}`);
    await this.page.evaluate(() => window.crowdquilt.ready);
  };

  /** Waits until the picture shows `secs`. */
  readonly seek = (secs: number) => this.page.evaluate((t) => window.crowdquilt.seek(t), secs);

  readonly state = () => this.page.evaluate(() => window.crowdquilt.state());
}
