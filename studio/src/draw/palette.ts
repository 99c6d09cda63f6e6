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

// Dealt as src/export/look.rs deals them, so that a person looks the same in exported files.
const SKIN = ["#f2c9ac", "#e5b08d", "#d49a74", "#b97a56", "#8d5a3c", "#6a422d", "#4b2f22"];
const HAIR = ["#2a211c", "#3d2b20", "#5b3d28", "#7d5a3c", "#a98657", "#1b1a1c", "#8b8783", "#9b4a2c"];
const SHIRT = [
  "#d0644a", "#e2a13f", "#4a8c86", "#3d6d9e", "#87608f", "#a9b9c2", "#efeae0", "#6b8a57", "#c98297", "#33425a",
  "#78a6c6", "#d6bd8c", "#b5483f", "#5aa18a", "#2b2d33", "#e3c7b0", "#5d5a94", "#9fb27a",
]; // biome-ignore format: a palette
const TROUSERS = [
  "#2f3a4d", "#46546a", "#6a5a4a", "#857b6b", "#262a31", "#3d4c45", "#5c4f5e", "#9a9484", "#6d8299", "#4a3a33",
]; // biome-ignore format: a palette
/** Shirts of teams. */
const TEAM = ["#2456a6", "#d4572a", "#2f8f5b", "#e0b12f", "#8a3fa0", "#1f9aa8"];
const SHOES = ["#f0ede6", "#3a2f29", "#23252a", "#8a5a3a", "#b3b6bb", "#7a3b36"];
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

/** A whole number from a person's number and a salt. */
function mixed(index: number, salt: number): number {
  let h = Math.imul(index + 1, 0x9e3779b1) ^ Math.imul(salt + 1, 0x85ebca6b);
  h = Math.imul(h ^ (h >>> 15), 0x2c1b3c6d);
  h = Math.imul(h ^ (h >>> 12), 0x297a2d39);
  return (h ^ (h >>> 15)) >>> 0;
}

/** A card from shuffled rounds of `kinds` cards, one for each person in turn, so that neighbours in number differ. */
function dealt(person: number, salt: number, kinds: number): number {
  const first = person - (person % kinds);
  const round = Array.from({ length: kinds }, (_, k) => k);
  const keys = round.map((k) => mixed(first + k, salt));
  return round.sort((a, b) => keys[a] - keys[b] || a - b)[person % kinds];
}

/** The parts of the mannequin that have a colour of their own, or are not there at all. */
export enum Part {
  Skin,
  /** On the skull, or a cap. */
  Hair,
  Shirt,
  /** Forearms: shirt or bare. */
  Sleeve,
  /** Thighs, unless under a skirt. */
  Trousers,
  /** Shins: trousers or bare. */
  Shin,
  Shoe,
  Sole,
  LongHair,
  Bun,
  /** A cap's. */
  Visor,
  Skirt,
  /** The hips under shirt and skirt. */
  Seat,
}
export const PART_COUNT = 13;

/**
 * The sRGB colour of every part of a person; null where the person has no such thing. Who is of a team wears its shirt,
 * with long sleeves.
 */
export function lookOf(person: number, team: number | null = null): (string | null)[] {
  const look = ownLookOf(person);
  if (team !== null) look[Part.Shirt] = look[Part.Sleeve] = TEAM[team % TEAM.length];
  return look;
}

function ownLookOf(person: number): (string | null)[] {
  const pick = (list: readonly string[], salt: number) => list[dealt(person, salt, list.length)];
  const [skin, shirt, trousers] = [pick(SKIN, 1), pick(SHIRT, 4), pick(TROUSERS, 5)];
  const [bottoms, style] = [dealt(person, 7, 8), dealt(person, 10, 8)];
  const [shorts, skirt] = [bottoms === 0, bottoms === 1];
  const long = style < 2 || (skirt && style > 2);
  const [bald, cap] = [style === 3 && !long, style === 4 && !long];
  const hair = cap ? pick(SHIRT, 11) : pick(HAIR, 3);
  return [
    skin,
    bald ? null : hair,
    shirt,
    dealt(person, 6, 2) === 0 ? skin : shirt,
    skirt ? null : trousers,
    skirt || shorts ? skin : trousers,
    pick(SHOES, 8),
    pick(SOLE, 9),
    long ? hair : null,
    style === 2 && !long ? hair : null,
    cap ? hair : null,
    skirt ? trousers : null,
    trousers,
  ];
}

/** sRGB bytes and presence (alpha) of every part of a person. */
export function looksOf(person: number, team: number | null = null): number[] {
  return lookOf(person, team).flatMap((color) => (color === null ? [0, 0, 0, 0] : [...bytes(color), 255]));
}

/** The colours of the roles of a kind, as on the contact sheet (python/crowdquilt/plot/sheet.py). */
const ROLES = ["#2d6fa3", "#d2603a", "#e0a02c", "#4f8f54", "#8659a3", "#b8508c", "#2f9c9a", "#7c6a45"];

/** The colour of a role of a kind. */
export function roleColor(role: number): string {
  return ROLES[role % ROLES.length];
}
