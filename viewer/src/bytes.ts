// Text to bytes, and archives.

type Base64Decoder = { fromBase64?: (text: string) => Uint8Array<ArrayBuffer> };

function decodeBase64(text: string): Uint8Array<ArrayBuffer> {
  const native = (Uint8Array as unknown as Base64Decoder).fromBase64;
  if (native) return native(text);
  const characters = atob(text);
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = characters.charCodeAt(i);
  return bytes;
}

/// The bytes that were deflated and then written as base64.
export async function inflate(text: string): Promise<Uint8Array> {
  const bytes = decodeBase64(text.trim());
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

const crcTable = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let bit = 0; bit < 8; ++bit) n = n & 1 ? (n >>> 1) ^ 0xedb88320 : n >>> 1;
  return n;
});

function crc32(bytes: Uint8Array): number {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = crcTable[(crc ^ byte) & 255]! ^ (crc >>> 8);
  return (crc ^ 0xffffffff) >>> 0;
}

/// A ZIP archive of files as they are (pictures are compressed already).
export function zip(files: { name: string; bytes: Uint8Array<ArrayBuffer> }[]): Blob {
  const parts: Uint8Array<ArrayBuffer>[] = [];
  const directory: Uint8Array<ArrayBuffer>[] = [];
  let offset = 0;
  const record = (numbers: [value: number, bytes: number][], name: Uint8Array): Uint8Array<ArrayBuffer> => {
    const length = numbers.reduce((sum, [, bytes]) => sum + bytes, 0);
    const view = new DataView(new ArrayBuffer(length + name.length));
    let at = 0;
    for (const [value, bytes] of numbers) {
      if (bytes === 4) view.setUint32(at, value, true);
      else view.setUint16(at, value, true);
      at += bytes;
    }
    const result = new Uint8Array(view.buffer);
    result.set(name, length);
    return result;
  };
  const date = 0x21; // the first of January 1980: archives of the same pictures are alike
  for (const { name, bytes } of files) {
    const nameBytes = new TextEncoder().encode(name);
    const common: [number, number][] = [[20, 2], [0x800, 2], [0, 2], [0, 2], [date, 2], [crc32(bytes), 4],
      [bytes.length, 4], [bytes.length, 4], [nameBytes.length, 2], [0, 2]];
    const header = record([[0x04034b50, 4], ...common], nameBytes);
    directory.push(record([[0x02014b50, 4], [20, 2], ...common, [0, 2], [0, 2], [0, 2], [0, 4], [offset, 4]], nameBytes));
    parts.push(header, bytes);
    offset += header.length + bytes.length;
  }
  const size = directory.reduce((sum, part) => sum + part.length, 0);
  const end = record([[0x06054b50, 4], [0, 2], [0, 2], [files.length, 2], [files.length, 2], [size, 4], [offset, 4],
    [0, 2]], new Uint8Array());
  return new Blob([...parts, ...directory, end], { type: "application/zip" });
}
