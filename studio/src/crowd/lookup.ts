/** Questions about a crowd that the panels ask: who is with whom, who does what when, how much is shared. */

import type { Character, Crowd, Fragment, Vec2 } from "./model";

export interface Member {
  person: number;
  fragment: Fragment;
}

/** Who takes part in every instance, by instance. */
export function membersOf(crowd: Crowd): Member[][] {
  const members: Member[][] = crowd.instances.map(() => []);
  for (const [person, character] of crowd.characters.entries()) {
    for (const fragment of character.fragments) members[fragment.instance].push({ person, fragment });
  }
  return members;
}

/** Index of the fragment that a character is in at `frame`; -1 if it has none. O(log fragments). */
export function fragmentAt(character: Character, frame: number): number {
  let [low, high] = [0, character.fragments.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (character.fragments[middle].begin <= frame) low = middle + 1;
    else high = middle;
  }
  return Math.max(low - 1, character.fragments.length > 0 ? 0 : -1);
}

/** The kind of a fragment's instance. */
export function kindOf(crowd: Crowd, fragment: Fragment) {
  return crowd.kinds[crowd.instances[fragment.instance]];
}

/** First and last frame of an instance inside the crowd's life. */
export function span(crowd: Crowd, members: Member[]): [begin: number, end: number] {
  const begin = Math.min(...members.map((m) => m.fragment.begin));
  const end = Math.max(...members.map((m) => m.fragment.end));
  return [Math.max(begin, 0), Math.min(end, crowd.lastFrame)];
}

/** Ground points of a member's path inside the crowd's life. */
export function pathPoints(crowd: Crowd, { fragment }: Member): Vec2[] {
  const points: Vec2[] = [];
  const frames = (fragment.end - fragment.begin) / Math.max(fragment.samples - 1, 1);
  for (let s = 0; s < fragment.samples; s++) {
    const frame = fragment.begin + s * frames;
    if (frame < -0.5 || frame > crowd.lastFrame + 0.5) continue;
    const at = (fragment.firstSample + s) * 2;
    points.push([crowd.pathPoints[at], crowd.pathPoints[at + 1]]);
  }
  return points;
}

/** Present people, and those of them in patches of two or more, in `bins` equal parts of the crowd's life. */
export function presence(crowd: Crowd, bins: number): { all: Float32Array; shared: Float32Array } {
  const all = new Float32Array(bins);
  const shared = new Float32Array(bins);
  const perBin = Math.max(crowd.lastFrame, 1) / bins;
  const add = (into: Float32Array, begin: number, end: number) => {
    const [from, to] = [begin / perBin, end / perBin];
    for (let bin = Math.floor(from); bin < Math.min(to, bins); bin++) {
      into[bin] += Math.min(to, bin + 1) - Math.max(from, bin);
    }
  };
  for (const c of crowd.characters) {
    const last = c.begin + Math.max(c.frames - 1, 0);
    add(all, c.begin, last);
    for (const f of c.fragments) {
      const [begin, end] = [Math.max(f.begin, c.begin), Math.min(f.end, last)];
      if (kindOf(crowd, f).people > 1 && end > begin) add(shared, begin, end);
    }
  }
  return { all, shared };
}

/** Share of all character-time spent in patches of two or more people. */
export function multiPersonShare(crowd: Crowd): number {
  const { all, shared } = presence(crowd, 64);
  const sum = (v: Float32Array) => v.reduce((a, b) => a + b, 0);
  return sum(all) > 0 ? sum(shared) / sum(all) : 0;
}
