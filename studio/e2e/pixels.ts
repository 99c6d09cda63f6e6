/** Reads the pixels of screenshots, in the browser itself: no image library needed. */

import type { Page } from "playwright-core";

export interface Pixels {
  width: number;
  height: number;
  data: Uint8Array;
}

/** A picture of the page as RGBA bytes. */
export async function screenshot(page: Page): Promise<Pixels> {
  const png = (await page.screenshot({ scale: "css" })).toString("base64");
  const { width, height, text } = await page.evaluate(async (encoded) => {
    const image = new Image();
    image.src = `data:image/png;base64,${encoded}`;
    await image.decode();
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext("2d") as OffscreenCanvasRenderingContext2D;
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    let binary = "";
    for (let i = 0; i < data.length; i += 32768) binary += String.fromCharCode(...data.subarray(i, i + 32768));
    return { width: image.width, height: image.height, text: btoa(binary) };
  }, png);
  return { width, height, data: new Uint8Array(Buffer.from(text, "base64")) };
}

/** Number of pixels that differ by more than `threshold` in any channel, within `radius` of a place or everywhere. */
export function changed(a: Pixels, b: Pixels, place?: { x: number; y: number }, radius = 3, threshold = 24): number {
  let count = 0;
  for (let i = 0; i < a.data.length; i += 4) {
    const [x, y] = [(i / 4) % a.width, Math.floor(i / 4 / a.width)];
    if (place && Math.max(Math.abs(x - place.x), Math.abs(y - place.y)) > radius) continue;
    const d = Math.max(...[0, 1, 2].map((k) => Math.abs(a.data[i + k] - b.data[i + k])));
    if (d > threshold) count++;
  }
  return count;
}
