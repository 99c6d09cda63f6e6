/** The project's binary container: 24 bytes of prelude, a JSON header, little-endian arrays. See src/container.rs. */

const PRELUDE = 24;

const ELEMENTS = { f32: Float32Array, i16: Int16Array, u32: Uint32Array, i32: Int32Array, u8: Uint8Array };
type ElementName = keyof typeof ELEMENTS;
type ArrayOf<T extends ElementName> = InstanceType<(typeof ELEMENTS)[T]>;
type Json = Record<string, unknown>;

/** A file that cannot be read: where, what was expected, what was found. */
export class FileProblem extends Error {
  constructor(
    readonly place: string,
    readonly problem: string,
  ) {
    super(`${place}: ${problem}`);
    this.name = "FileProblem";
  }
}

/** An opened container. Arrays are views of the file's bytes, not copies. */
export class Container {
  private constructor(
    readonly header: Json,
    readonly headerText: string,
    private readonly buffer: ArrayBuffer,
    private readonly dataStart: number,
  ) {}

  /** Opens a container, or throws a FileProblem: wrong magic, another version, cut or overlong, no JSON object. */
  static open(buffer: ArrayBuffer, magic: string, versions: readonly number[]): Container {
    const found = new TextDecoder("latin1").decode(new Uint8Array(buffer, 0, Math.min(8, buffer.byteLength)));
    if (found !== magic.padEnd(8, "\0")) {
      throw new FileProblem("byte 0", `expected the magic bytes "${magic}", found ${shown(found)}`);
    }
    if (buffer.byteLength < PRELUDE) {
      throw new FileProblem(
        "byte 8",
        `expected ${PRELUDE} bytes of prelude, found ${buffer.byteLength}: the file is cut`,
      );
    }
    const view = new DataView(buffer);
    const foundVersion = view.getUint32(8, true);
    if (!versions.includes(foundVersion)) {
      throw new FileProblem("byte 8", `expected version ${versions.join(" or ")}, found ${foundVersion}`);
    }
    const headerLength = view.getUint32(12, true);
    const expected = PRELUDE + headerLength + Number(view.getBigUint64(16, true));
    if (buffer.byteLength !== expected) {
      const why = buffer.byteLength < expected ? "the file is cut" : "there are extra bytes";
      throw new FileProblem("byte 12", `expected ${expected} bytes in all, found ${buffer.byteLength}: ${why}`);
    }
    const text = new TextDecoder().decode(new Uint8Array(buffer, PRELUDE, headerLength));
    return new Container(parseObject(text), text, buffer, PRELUDE + headerLength);
  }

  /** The array `name`, which must be of that type and lie inside the data. */
  has(name: string): boolean {
    return object(this.header.arrays, "header.arrays")[name] !== undefined;
  }

  array<T extends ElementName>(name: string, type: T): ArrayOf<T> {
    const place = `array ${name}`;
    const table = object(this.header.arrays, "header.arrays");
    if (table[name] === undefined) throw new FileProblem(place, "expected, not found");
    const info = object(table[name], place);
    if (info.type !== type) throw new FileProblem(place, `expected type ${type}, found ${shown(info.type)}`);
    const offset = count(info.offset, `${place}, offset`);
    const length = count(info.count, `${place}, count`);
    const Type = ELEMENTS[type];
    const start = this.dataStart + offset;
    if (start + length * Type.BYTES_PER_ELEMENT > this.buffer.byteLength || offset % Type.BYTES_PER_ELEMENT !== 0) {
      throw new FileProblem(place, "lies outside the data");
    }
    // A header whose length is no multiple of 8 is legal but unaligned: only then copy.
    const aligned = start % Type.BYTES_PER_ELEMENT === 0;
    const buffer = aligned ? this.buffer : this.buffer.slice(start, start + length * Type.BYTES_PER_ELEMENT);
    return new Type(buffer, aligned ? start : 0, length) as ArrayOf<T>;
  }
}

function parseObject(text: string): Json {
  try {
    return object(JSON.parse(text), "header");
  } catch (error) {
    if (error instanceof FileProblem) throw error;
    throw new FileProblem("header", `expected a JSON object: ${(error as Error).message}`);
  }
}

/** `value` as a JSON object. */
export function object(value: unknown, place: string): Json {
  if (typeof value !== "object" || value === null || Array.isArray(value)) {
    throw new FileProblem(place, `expected an object, found ${shown(value)}`);
  }
  return value as Json;
}

/** `value` as a list. */
export function list(value: unknown, place: string): unknown[] {
  if (!Array.isArray(value)) throw new FileProblem(place, `expected a list, found ${shown(value)}`);
  return value;
}

/** `value` as a finite number. */
export function finite(value: unknown, place: string): number {
  if (typeof value !== "number" || !Number.isFinite(value)) {
    throw new FileProblem(place, `expected a number, found ${shown(value)}`);
  }
  return value;
}

/** `value` as a whole number. */
export function whole(value: unknown, place: string): number {
  const n = finite(value, place);
  if (!Number.isSafeInteger(n)) throw new FileProblem(place, `expected a whole number, found ${n}`);
  return n;
}

/** `value` as a whole number that is not negative. */
export function count(value: unknown, place: string): number {
  const n = whole(value, place);
  if (n < 0) throw new FileProblem(place, `expected a number that is not negative, found ${n}`);
  return n;
}

/** `value` as text. */
export function text(value: unknown, place: string): string {
  if (typeof value !== "string") throw new FileProblem(place, `expected text, found ${shown(value)}`);
  return value;
}

/** A short form of any value for messages. */
export function shown(value: unknown): string {
  if (value === undefined) return "nothing";
  const json = JSON.stringify(value) ?? String(value);
  return json.length > 40 ? `${json.slice(0, 40)}...` : json;
}
