/** What is marked on the floor around a kind's people: paths, seconds, ports with their pose groups, who touches now. */

import { Group, Mesh, MeshBasicMaterial, RingGeometry, type Sprite } from "three";
import type { Crowd, Vec3 } from "../crowd/model";
import { Pose, samplePose, sampleRoot } from "../crowd/sample";
import { type BodyPart, type PatchSet, type SetKind, words } from "../set/model";
import { partOf } from "../set/parts";
import { roleColor } from "./palette";
import { halo } from "./signs";
import { Way } from "./way";

export class Marks {
  readonly group = new Group();
  private readonly rings: Mesh[] = [];
  private readonly touches: Sprite[] = [];
  private readonly poses: Pose[];

  constructor(
    set: PatchSet,
    private readonly kind: SetKind,
    private readonly crowd: Crowd,
  ) {
    this.poses = crowd.characters.map(() => new Pose(crowd.joints.length));
    for (const [role, own] of kind.roles.entries()) {
      const color = roleColor(role);
      const ways = new Way(set, kind, crowd, role);
      this.group.add(...ways.onFloor(color));
      this.group.add(ways.label(0, `${words(set.groups[own.entry])} →`, color));
      this.group.add(ways.label(own.frames - 1, `→ ${words(set.groups[own.exit])}`, color));
      this.rings.push(ring(color));
    }
    this.touches = kind.contacts.map(() => halo());
    this.group.add(...this.rings, ...this.touches);
  }

  /** Moves what moves. */
  update(secs: number): void {
    const at = [0, 0, 0];
    for (const [person, ring] of this.rings.entries()) {
      ring.visible = sampleRoot(this.crowd, person, secs, at);
      ring.position.set(at[0], 0.012, at[2]);
    }
    const frame = secs * this.crowd.fps;
    for (const [i, { a, b, begin, end }] of this.kind.contacts.entries()) {
      const touch = this.touches[i];
      touch.visible = frame >= begin - 0.5 && frame <= end + 0.5;
      if (!touch.visible) continue;
      const [p, q] = [a, b].map((side) => this.part(side.role, side.part, secs));
      if (p && q) touch.position.set((p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2);
      else touch.visible = false;
    }
  }

  /** Where a part of somebody's body is; null while absent. */
  private part(role: number, part: BodyPart, secs: number): Vec3 | null {
    const pose = this.poses[role];
    if (!samplePose(this.crowd, role, secs, pose)) return null;
    return partOf(this.crowd, pose, part);
  }
}

/** The ring under somebody, in the colour of the role. */
function ring(color: string): Mesh {
  const material = new MeshBasicMaterial({ color, transparent: true, opacity: 0.9, depthWrite: false });
  const mesh = new Mesh(new RingGeometry(0.27, 0.305, 48).rotateX(-Math.PI / 2), material);
  mesh.renderOrder = 1.8;
  return mesh;
}
