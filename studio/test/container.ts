/** Writes the project's binary container, as src/container.rs does. */

type Arrays = Record<string, [type: string, values: Float32Array | Int16Array]>;

export function container(
  header: Record<string, unknown>,
  version: number,
  arrays: Arrays,
  alter?: (header: Record<string, unknown>) => void,
): ArrayBuffer {
  const table: Record<string, unknown> = {};
  let length = 0;
  for (const [name, [type, values]] of Object.entries(arrays)) {
    length = Math.ceil(length / 8) * 8;
    table[name] = { type, offset: length, count: values.length };
    length += values.byteLength;
  }
  const whole = { ...header, arrays: table };
  alter?.(whole);
  let json = JSON.stringify(whole);
  json = json.padEnd(Math.ceil(json.length / 8) * 8, " ");
  const text = new TextEncoder().encode(json);
  const out = new Uint8Array(24 + text.length + length);
  const view = new DataView(out.buffer);
  out.set(new TextEncoder().encode("CQCROWD\0"));
  view.setUint32(8, version, true);
  view.setUint32(12, text.length, true);
  view.setBigUint64(16, BigInt(length), true);
  out.set(text, 24);
  let offset = 0;
  for (const [, values] of Object.values(arrays)) {
    offset = Math.ceil(offset / 8) * 8;
    out.set(new Uint8Array(values.buffer, values.byteOffset, values.byteLength), 24 + text.length + offset);
    offset += values.byteLength;
  }
  return out.buffer;
}
