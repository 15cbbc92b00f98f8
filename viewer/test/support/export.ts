// MCAP files made by the program, and what the format's own reader finds in them.

import { spawnSync } from "node:child_process";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { McapIndexedReader } from "@mcap/core";
import { decompress } from "fzstd";

export const repository = join(dirname(fileURLToPath(import.meta.url)), "../../..");
export const program = process.env.SNUG || join(repository, "build/snug");
export const demonstrator = join(repository, "scenarios/box-demonstrator.yaml");
export const unpack = { zstd: (bytes: Uint8Array, size: bigint) => decompress(bytes, new Uint8Array(Number(size))) };

export type Json = Record<string, any>;
export interface Message {
  topic: string;
  schema: string;
  ns: bigint;
  data: Json;
}

export function snug(...words: string[]): void {
  const done = spawnSync(program, words, { encoding: "utf8" });
  if (done.status !== 0) throw new Error(`snug ${words.join(" ")}: ${done.stderr || done.error}`);
}

export function opened(file: Uint8Array): Promise<McapIndexedReader> {
  const readable = {
    size: async () => BigInt(file.length),
    read: async (offset: bigint, size: bigint) => file.slice(Number(offset), Number(offset + size)),
  };
  return McapIndexedReader.Initialize({ readable, decompressHandlers: unpack });
}

export async function messagesOf(reader: McapIndexedReader, args: Json = {}): Promise<Message[]> {
  const list: Message[] = [];
  for await (const message of reader.readMessages({ validateCrcs: true, ...args })) {
    const channel = reader.channelsById.get(message.channelId)!;
    list.push({
      topic: channel.topic,
      schema: reader.schemasById.get(channel.schemaId)!.name,
      ns: message.logTime,
      data: JSON.parse(Buffer.from(message.data).toString("utf8")),
    });
  }
  return list;
}
