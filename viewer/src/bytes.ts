/// Bytes that came as text.

/** Of base64, with or without "data:...," before it. */
export function bytesOf(text: string): Uint8Array<ArrayBuffer> {
  const packed = atob(text.slice(text.indexOf(',') + 1));
  const bytes = new Uint8Array(packed.length);
  for (let i = 0; i < packed.length; ++i) bytes[i] = packed.charCodeAt(i);
  return bytes;
}
