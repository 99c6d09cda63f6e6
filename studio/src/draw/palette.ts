/** All colours of the picture. */

import { Color, SRGBColorSpace } from "three";

/** Colours and lights of the scene; the page's own are in style.css. */
export interface Theme {
  background: string;
  ground: string;
  region: string;
  line: string;
  border: string;
  obstacle: string;
  sky: string;
  bounce: string;
  sun: string;
  skyStrength: number;
  sunStrength: number;
}

export const LIGHT: Theme = {
  background: "#e9e7e2",
  ground: "#e4e1db",
  region: "#f4f2ee",
  line: "#b9b4a9",
  border: "#6f6a60",
  obstacle: "#cfcac0",
  sky: "#f4f6ff",
  bounce: "#c9b7a1",
  sun: "#fff3df",
  skyStrength: 1.85,
  sunStrength: 1.75,
};

const SKIN = ["#f2c9ac", "#e5b08d", "#d49a74", "#b97a56", "#8d5a3c", "#6a422d"];
const HAIR = ["#2a211c", "#3d2b20", "#5b3d28", "#7d5a3c", "#a98657", "#1b1a1c", "#8b8783"];
const SHIRT = [
  "#d0644a", "#e2a13f", "#4a8c86", "#3d6d9e", "#87608f", "#a9b9c2", "#efeae0", "#6b8a57", "#c98297", "#33425a",
  "#78a6c6", "#d6bd8c", "#b5483f", "#5aa18a",
]; // biome-ignore format: a palette
const TROUSERS = ["#2f3a4d", "#46546a", "#6a5a4a", "#857b6b", "#262a31", "#3d4c45", "#5c4f5e", "#9a9484"];
const SHOES = ["#f0ede6", "#3a2f29", "#23252a", "#8a5a3a", "#b3b6bb"];
const SOLE = ["#dedad2", "#2a2725", "#e9e6df"];

/** Evenly different hues of one calm family, for kinds and instances. */
export function categorical(index: number): string {
  const hue = (0.055 + index * 0.381966) % 1;
  const light = [0.6, 0.5, 0.67][index % 3];
  return `#${new Color().setHSL(hue, 0.55, light, SRGBColorSpace).getHexString()}`;
}

/** sRGB bytes of a CSS colour. */
export function bytes(color: string): [number, number, number] {
  const hex = Number.parseInt(color.slice(1), 16);
  return [hex >> 16, (hex >> 8) & 255, hex & 255];
}

/** A whole number from a person's index and a salt: the same person looks the same every time. */
export function mixed(index: number, salt: number): number {
  let h = Math.imul(index + 1, 0x9e3779b1) ^ Math.imul(salt + 1, 0x85ebca6b);
  h = Math.imul(h ^ (h >>> 15), 0x2c1b3c6d);
  h = Math.imul(h ^ (h >>> 12), 0x297a2d39);
  return (h ^ (h >>> 15)) >>> 0;
}

/** The parts of the mannequin that have a colour of their own. */
export enum Part {
  Skin,
  Hair,
  Shirt,
  /** Forearms: shirt or bare. */
  Sleeve,
  Trousers,
  /** Shins: trousers or bare. */
  Shin,
  Shoe,
  Sole,
  /** Long hair: there or not. */
  LongHair,
}
export const PART_COUNT = 9;

/** sRGB colour and presence (alpha) of every part of a person. */
export function looksOf(person: number): number[] {
  const pick = (list: readonly string[], salt: number) => list[mixed(person, salt) % list.length];
  const skin = pick(SKIN, 1);
  const hair = mixed(person, 2) % 11 === 0 ? "#9b4a2c" : pick(HAIR, 3);
  const shirt = pick(SHIRT, 4);
  const trousers = pick(TROUSERS, 5);
  const sleeve = mixed(person, 6) % 2 === 0 ? skin : shirt;
  const shin = mixed(person, 7) % 6 === 0 ? skin : trousers;
  const colors = [skin, hair, shirt, sleeve, trousers, shin, pick(SHOES, 8), pick(SOLE, 9), hair];
  const long = mixed(person, 10) % 5 < 2;
  return colors.flatMap((color, part) => [...bytes(color), part === Part.LongHair && !long ? 0 : 255]);
}
