/// Films the motion frame by frame: every frame is drawn and encoded, however long that takes.

import { writeWebm, type EncodedFrame } from './webm';

export interface Film {
  width: number;
  height: number;
  fps: number;
  /** Number of frames. */
  count: number;
  /** Draws frame i on the canvas. */
  draw(i: number): void;
}

const codecs = [
  { codec: 'vp09.00.40.08', name: 'V_VP9' },
  { codec: 'vp8', name: 'V_VP8' },
];

export async function recordWebm(canvas: HTMLCanvasElement, film: Film): Promise<Blob> {
  if (typeof VideoEncoder === 'undefined') throw new Error('this browser has no video encoder (WebCodecs)');
  const { width, height, fps, count } = film;
  const size = { width, height, framerate: fps, bitrate: Math.round(0.12 * width * height * fps), latencyMode: 'quality' as const };
  let chosen = null;
  for (const entry of codecs) {
    const { supported } = await VideoEncoder.isConfigSupported({ ...size, codec: entry.codec });
    if (supported && !chosen) chosen = entry;
  }
  if (!chosen) throw new Error(`this browser encodes neither VP9 nor VP8 at ${width} x ${height}`);
  const frames: EncodedFrame[] = [];
  let failure: Error | null = null;
  const encoder = new VideoEncoder({
    output: (chunk) => {
      const data = new Uint8Array(chunk.byteLength);
      chunk.copyTo(data);
      frames.push({ data, time: Math.round(chunk.timestamp / 1000), key: chunk.type === 'key' });
    },
    error: (error) => (failure = error),
  });
  encoder.configure({ ...size, codec: chosen.codec });
  for (let i = 0; i < count && !failure; ++i) {
    film.draw(i);
    const frame = new VideoFrame(canvas, { timestamp: Math.round((i * 1e6) / fps), duration: Math.round(1e6 / fps) });
    encoder.encode(frame, { keyFrame: i % (2 * fps) === 0 });
    frame.close();
    while (encoder.encodeQueueSize > 2) await new Promise((resolve) => setTimeout(resolve, 5));
  }
  if (failure) throw failure;
  await encoder.flush();
  encoder.close();
  return new Blob(writeWebm(frames, chosen.name, width, height, (1000 * count) / fps) as BlobPart[], { type: 'video/webm' });
}
