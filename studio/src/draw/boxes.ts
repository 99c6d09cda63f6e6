/** The boxes that people carry: cardboard with a strip of tape, one draw call for all board and one for all tape. */

import {
  BoxGeometry,
  type BufferGeometry,
  Color,
  Group,
  InstancedMesh,
  Matrix4,
  MeshStandardMaterial,
  Quaternion,
  Vector3,
} from "three";
import { mergeGeometries } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import type { Crowd } from "../crowd/model";
import { sampleProp } from "../crowd/sample";

const BOARD = 0xb68a5a;
const TAPE = 0xd9c7a3;
/** Parts of a box that is one metre each way: how wide the tape is, how far it lies off, how far it reaches down. */
const TAPE_WIDTH = 0.17;
const TAPE_LIFT = 0.004;
const TAPE_END = 0.3;
const UP = new Vector3(0, 1, 0);

export class Boxes {
  readonly group = new Group();
  private readonly meshes: InstancedMesh[];
  private readonly place = [0, 0, 0, 0];
  private readonly matrix = new Matrix4();
  private readonly at = new Vector3();
  private readonly turn = new Quaternion();
  private readonly size = new Vector3();

  constructor(private readonly crowd: Crowd) {
    const make = (geometry: BufferGeometry, color: number, roughness: number) => {
      const material = new MeshStandardMaterial({ color: new Color(color), roughness, metalness: 0 });
      const mesh = new InstancedMesh(geometry, material, crowd.props.length);
      mesh.castShadow = mesh.receiveShadow = true;
      mesh.frustumCulled = false;
      return mesh;
    };
    this.meshes = crowd.props.length > 0 ? [make(new BoxGeometry(), BOARD, 0.95), make(tape(), TAPE, 0.6)] : [];
    for (const mesh of this.meshes) this.group.add(mesh);
  }

  /** Brings all boxes to `secs` and raises them by `lift`; what is not there has no size. */
  update(secs: number, lift: number, shadows: boolean): void {
    for (const [i, prop] of this.crowd.props.entries()) {
      if (sampleProp(this.crowd, i, secs, this.place)) {
        const [x, y, z, heading] = this.place;
        this.turn.setFromAxisAngle(UP, heading);
        this.matrix.compose(this.at.set(x, y + lift, z), this.turn, this.size.set(...prop.size));
      } else {
        this.matrix.makeScale(0, 0, 0);
      }
      for (const mesh of this.meshes) mesh.setMatrixAt(i, this.matrix);
    }
    for (const mesh of this.meshes) {
      mesh.castShadow = shadows;
      mesh.instanceMatrix.needsUpdate = true;
    }
  }
}

/** A strip over the top and down both sides. */
function tape(): BufferGeometry {
  const outer = 1 + 2 * TAPE_LIFT;
  const top = new BoxGeometry(outer, TAPE_LIFT, TAPE_WIDTH).translate(0, 0.5 + TAPE_LIFT / 2, 0);
  const side = (x: number) =>
    new BoxGeometry(TAPE_LIFT, TAPE_END, TAPE_WIDTH).translate(x * (0.5 + TAPE_LIFT / 2), 0.5 - TAPE_END / 2, 0);
  return mergeGeometries([top, side(1), side(-1)]);
}
