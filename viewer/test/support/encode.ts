// A small encoder of the replay form, written from docs/formats.md: the tests' own second opinion on the decoder.

import { deflateSync } from "node:zlib";

export interface ChannelInput {
  name: string;
  columns: string[];
  unit?: string;
  frame?: string;
  quantum: number;
  rows: number[][];
  encoding?: "delta" | "raw";
}

function leb128(value: bigint, out: number[]): void {
  do {
    const low = Number(value & 127n);
    value >>= 7n;
    out.push(value > 0n ? low | 128 : low);
  } while (value > 0n);
}

export function encodeColumn(values: number[], quantum: number, isDelta: boolean): number[] {
  const out: number[] = [];
  let last = 0n;
  for (const value of values) {
    if (!Number.isFinite(value)) {
      leb128(0n, out);
      continue;
    }
    const i = BigInt(Math.round(value / quantum));
    const d = isDelta ? i - last : i;
    last = i;
    leb128((d >= 0n ? 2n * d : -2n * d - 1n) + 1n, out);
  }
  return out;
}

/** Whole replay form from a header (without channels) and channels. */
export function encodeReplay(header: object, channels: ChannelInput[]): Uint8Array {
  const data: number[] = [];
  const metas = channels.map((c) => {
    const offset = data.length;
    for (let k = 0; k < c.columns.length; ++k) {
      for (const byte of encodeColumn(c.rows.map((row) => row[k]!), c.quantum, c.encoding !== "raw")) data.push(byte);
    }
    return {
      name: c.name, columns: c.columns, unit: c.unit ?? "", frame: c.frame ?? "", quantum: c.quantum,
      rows: c.rows.length, offset, bytes: data.length - offset, encoding: c.encoding ?? "delta",
    };
  });
  return packReplay({ ...header, channels: metas }, Uint8Array.from(data));
}

export function packReplay(header: object, data: Uint8Array): Uint8Array {
  const text = new TextEncoder().encode(JSON.stringify(header));
  const content = new Uint8Array(4 + text.length + data.length);
  new DataView(content.buffer).setUint32(0, text.length, true);
  content.set(text, 4);
  content.set(data, 4 + text.length);
  const packed = deflateSync(content);
  const out = new Uint8Array(8 + packed.length);
  out.set(new TextEncoder().encode("SNUGRPL1"), 0);
  out.set(packed, 8);
  return out;
}
