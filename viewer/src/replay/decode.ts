// Decoder of the replay form: bytes in, header and columns out; refuses what is broken or too large, with a reason.

import { ReplayError } from "./errors";
import { completeHeader, type ChannelMeta, type Header } from "./header";

const MAGIC = "SNUGRPL1";
const NEWEST_VERSION = 1;

/** Limits of what the page opens, bytes. They keep a page below 300 MB. */
export interface Limits {
  inflated: number;
  decoded: number;
}
export const DEFAULT_LIMITS: Limits = { inflated: 160e6, decoded: 180e6 };

export type Column = Float32Array | Float64Array;

export interface DecodedChannel {
  meta: ChannelMeta;
  columns: Column[];
}

export interface Decoded {
  header: Header;
  channels: Map<string, DecodedChannel>;
  /** Size of the file or message, bytes. */
  size: number;
}

const REMAKE = "Make it again with `snug report RECORDING.h5 -o report.html`.";
const mega = (bytes: number): string => `${(bytes / 1e6).toFixed(0)} MB`;

function tooLarge(what: string, limit: number): ReplayError {
  return new ReplayError(
    "This recording is too large for a page",
    `${what}; the page opens up to ${mega(limit)}.`,
    "Show a part of the run (`snug simulate --until SECONDS`), or read the .h5 file itself.",
  );
}

async function inflate(compressed: Uint8Array, limit: number): Promise<Uint8Array> {
  const stream = new DecompressionStream("deflate");
  const writer = stream.writable.getWriter();
  // Failures of the writing side show on the reading side too; the latter is the one that is awaited.
  void writer.write(compressed as Uint8Array<ArrayBuffer>).catch(() => {});
  void writer.close().catch(() => {});
  const reader = stream.readable.getReader();
  const chunks: Uint8Array[] = [];
  let total = 0;
  try {
    for (;;) {
      const { done, value } = await reader.read();
      if (done) break;
      total += value.length;
      if (total > limit) {
        void reader.cancel().catch(() => {});
        throw tooLarge(`It is more than ${mega(limit)} when unpacked`, limit);
      }
      chunks.push(value);
    }
  } catch (error) {
    if (error instanceof ReplayError) throw error;
    throw new ReplayError("This recording is broken", "its compressed data end early or are damaged.", REMAKE);
  }
  const all = new Uint8Array(total);
  let at = 0;
  for (const chunk of chunks) {
    all.set(chunk, at);
    at += chunk.length;
  }
  return all;
}

function parseHeader(text: string): Header {
  let header: Header;
  try {
    header = completeHeader(JSON.parse(text) as Partial<Header>);
  } catch {
    throw new ReplayError("This recording is broken", "its header is not JSON.", REMAKE);
  }
  if (header.format !== "snug replay") {
    throw new ReplayError("This is not a recording of snug", `its header says format "${header.format}".`, REMAKE);
  }
  if (header.version > NEWEST_VERSION) {
    throw new ReplayError(
      "This recording is newer than the page",
      `it has version ${header.version} of the replay form, the page reads up to ${NEWEST_VERSION}.`,
      "Make the report with the snug that wrote the recording.",
    );
  }
  return header;
}

function checkChannel(meta: ChannelMeta, dataBytes: number): void {
  const { name, columns, rows, offset, bytes, quantum, encoding } = meta;
  const whole = (x: number): boolean => Number.isInteger(x) && x >= 0;
  const isSound =
    typeof name === "string" && Array.isArray(columns) && columns.length > 0 && whole(rows) && whole(offset) &&
    whole(bytes) && quantum > 0 && (encoding === "delta" || encoding === "raw");
  if (!isSound) throw new ReplayError("This recording is broken", `the entry of channel "${name}" is invalid.`, REMAKE);
  // Every value takes at least one byte, so a count of rows that the data cannot hold is found before memory is taken.
  if (offset + bytes > dataBytes || rows * columns.length > bytes) {
    throw new ReplayError("This recording is broken", `channel "${name}" reaches beyond the end of the data.`, REMAKE);
  }
}

/** Numbers that count or refer to rows need more than the 24 bits of a Float32Array; so does time. */
const isExact = (meta: ChannelMeta): boolean =>
  meta.name === "time" || (meta.quantum === 1 && meta.name.startsWith("contacts."));

function decodeChannel(meta: ChannelMeta, data: Uint8Array): DecodedChannel {
  const columns: Column[] = [];
  const end = meta.offset + meta.bytes;
  const isDelta = meta.encoding === "delta";
  // 1 / quantum is a whole number for all quanta in use: dividing gives the double nearest to the decimal number.
  const scale = Math.round(1 / meta.quantum);
  const divides = scale > 1 && Math.abs(scale * meta.quantum - 1) < 1e-12;
  let at = meta.offset;
  for (let c = 0; c < meta.columns.length; ++c) {
    const out = isExact(meta) ? new Float64Array(meta.rows) : new Float32Array(meta.rows);
    let last = 0;
    for (let row = 0; row < meta.rows; ++row) {
      let byte = data[at++]!;
      let u = byte & 127;
      if (byte >= 128) {
        let weight = 128;
        do {
          byte = at < end ? data[at]! : 0;
          ++at;
          u += (byte & 127) * weight;
          weight *= 128;
        } while (byte >= 128 && weight < 2 ** 56);
      }
      if (u === 0) {
        out[row] = NaN;
        continue;
      }
      const z = u - 1;
      const difference = z % 2 === 0 ? z / 2 : -(z + 1) / 2;
      const i = isDelta ? last + difference : difference;
      last = i;
      out[row] = divides ? i / scale : i * meta.quantum;
    }
    columns.push(out);
  }
  if (at !== end) {
    throw new ReplayError("This recording is broken", `channel "${meta.name}" does not fill its place in the data.`, REMAKE);
  }
  return { meta, columns };
}

/** Decodes a whole file or message. Throws ReplayError. */
export async function decodeReplay(bytes: Uint8Array, limits: Limits = DEFAULT_LIMITS): Promise<Decoded> {
  if (bytes.length < MAGIC.length || String.fromCharCode(...bytes.subarray(0, MAGIC.length)) !== MAGIC) {
    throw new ReplayError(
      "This is not a recording of snug",
      bytes.length === 0 ? "it is empty." : "it does not begin with SNUGRPL1.",
      REMAKE,
    );
  }
  const content = await inflate(bytes.subarray(MAGIC.length), limits.inflated);
  if (content.length < 4) throw new ReplayError("This recording is broken", "it ends before its header.", REMAKE);
  const headerBytes = new DataView(content.buffer).getUint32(0, true);
  if (4 + headerBytes > content.length) {
    throw new ReplayError("This recording is broken", "it ends within its header.", REMAKE);
  }
  const header = parseHeader(new TextDecoder().decode(content.subarray(4, 4 + headerBytes)));
  const data = content.subarray(4 + headerBytes);
  let decoded = 0;
  for (const meta of header.channels) {
    checkChannel(meta, data.length);
    decoded += meta.rows * meta.columns.length * (isExact(meta) ? 8 : 4);
  }
  if (decoded > limits.decoded) throw tooLarge(`Its ${header.frames} frames take ${mega(decoded)}`, limits.decoded);
  const channels = new Map<string, DecodedChannel>();
  for (const meta of header.channels) channels.set(meta.name, decodeChannel(meta, data));
  return { header, channels, size: bytes.length };
}

/** Base64 (white space allowed) to bytes. Throws ReplayError. */
export function decodeBase64(text: string): Uint8Array {
  try {
    const native = (Uint8Array as unknown as { fromBase64?: (t: string) => Uint8Array }).fromBase64;
    if (native) return native.call(Uint8Array, text);
    const binary = atob(text);
    const bytes = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
    return bytes;
  } catch {
    throw new ReplayError("This recording is broken", "its data in the page are not base64.", REMAKE);
  }
}
