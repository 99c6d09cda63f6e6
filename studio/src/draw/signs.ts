/** Drawings that always face the viewer: words in a frame, the ring around a touch. */

import { CanvasTexture, Color, Sprite, SpriteMaterial, SRGBColorSpace } from "three";

/** A small sign with rounded corners that always faces the viewer. */
export function sign(text: string, color: string): Sprite {
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("2d") as CanvasRenderingContext2D;
  const font = '600 44px "Inter Variable", Inter, system-ui, sans-serif';
  context.font = font;
  [canvas.width, canvas.height] = [Math.ceil(context.measureText(text).width) + 44, 76];
  context.font = font;
  context.fillStyle = "rgb(252 251 249 / 88%)";
  context.beginPath();
  context.roundRect(2, 2, canvas.width - 4, canvas.height - 4, 34);
  context.fill();
  context.fillStyle = `#${new Color(color).lerp(new Color("#25231f"), 0.25).getHexString()}`;
  context.textBaseline = "middle";
  context.fillText(text, 22, canvas.height / 2 + 2);
  const made = sprite(canvas, true);
  made.scale.set((0.15 * canvas.width) / canvas.height, 0.15, 1);
  made.renderOrder = 3;
  return made;
}

/** A bright ring around the place where people touch, seen through bodies. */
export function halo(): Sprite {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 128;
  const context = canvas.getContext("2d") as CanvasRenderingContext2D;
  const glow = context.createRadialGradient(64, 64, 0, 64, 64, 62);
  glow.addColorStop(0, "rgb(255 190 90 / 55%)");
  glow.addColorStop(0.5, "rgb(255 170 60 / 25%)");
  glow.addColorStop(0.68, "rgb(240 140 40 / 30%)");
  glow.addColorStop(0.74, "rgb(255 176 70 / 100%)");
  glow.addColorStop(0.84, "rgb(255 176 70 / 100%)");
  glow.addColorStop(0.9, "rgb(240 140 40 / 20%)");
  glow.addColorStop(1, "rgb(240 140 40 / 0%)");
  context.fillStyle = glow;
  context.fillRect(0, 0, 128, 128);
  const made = sprite(canvas, false);
  made.scale.setScalar(0.24);
  made.renderOrder = 4;
  return made;
}

function sprite(canvas: HTMLCanvasElement, depthTest: boolean): Sprite {
  const map = new CanvasTexture(canvas);
  map.colorSpace = SRGBColorSpace;
  return new Sprite(new SpriteMaterial({ map, depthTest, depthWrite: false, toneMapped: false }));
}
