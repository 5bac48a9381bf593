/// Writes a WebM file of video frames that are already encoded.
/// Ref: RFC 8794 (EBML), RFC 9559 (Matroska).

export interface EncodedFrame {
  data: Uint8Array;
  /** [ms] */
  time: number;
  key: boolean;
}

type Content = Uint8Array | Content[];

function flatten(content: Content): Uint8Array[] {
  return content instanceof Uint8Array ? [content] : content.flatMap(flatten);
}

function length(content: Content): number {
  return flatten(content).reduce((sum, part) => sum + part.length, 0);
}

/** Big-endian, in as few bytes as it takes. */
function unsigned(value: number): Uint8Array {
  const bytes = [];
  for (let rest = value; rest > 0 || bytes.length === 0; rest = Math.floor(rest / 256)) bytes.unshift(rest % 256);
  return Uint8Array.from(bytes);
}

/** Size of an element: eight bytes, the first of them a marker. */
function size(value: number): Uint8Array {
  const bytes = new Uint8Array(8);
  bytes[0] = 1;
  for (let i = 7, rest = value; i > 0; --i, rest = Math.floor(rest / 256)) bytes[i] = rest % 256;
  return bytes;
}

function element(id: number, ...content: Content[]): Content {
  return [unsigned(id), size(length(content)), ...content];
}

function float(value: number): Uint8Array {
  const bytes = new Uint8Array(8);
  new DataView(bytes.buffer).setFloat64(0, value);
  return bytes;
}

const text = (value: string): Uint8Array => new TextEncoder().encode(value);

function block(frame: EncodedFrame, clusterTime: number): Content {
  const head = new Uint8Array(4);
  head[0] = 0x81;  // Track 1.
  new DataView(head.buffer).setInt16(1, frame.time - clusterTime);
  head[3] = frame.key ? 0x80 : 0;
  return element(0xa3, head, frame.data);
}

/** A cluster begins at every key frame, at most 30 s after the one before. */
function clusters(frames: EncodedFrame[]): Content[] {
  const groups: EncodedFrame[][] = [];
  for (const frame of frames) {
    const group = groups[groups.length - 1];
    if (!group || frame.key || frame.time - group[0].time > 30000) groups.push([frame]);
    else group.push(frame);
  }
  return groups.map((group) => {
    const time = group[0].time;
    return element(0x1f43b675, element(0xe7, unsigned(time)), ...group.map((frame) => block(frame, time)));
  });
}

/** @param codec "V_VP8" or "V_VP9"  @param duration [ms] */
export function writeWebm(frames: EncodedFrame[], codec: string, width: number, height: number, duration: number): Uint8Array[] {
  const header = element(
    0x1a45dfa3,
    element(0x4286, unsigned(1)),
    element(0x42f7, unsigned(1)),
    element(0x42f2, unsigned(4)),
    element(0x42f3, unsigned(8)),
    element(0x4282, text('webm')),
    element(0x4287, unsigned(4)),
    element(0x4285, unsigned(2)),
  );
  const info = element(
    0x1549a966,
    element(0x2ad7b1, unsigned(1000000)),  // Times are in ms.
    element(0x4489, float(duration)),
    element(0x4d80, text('tandem')),
    element(0x5741, text('tandem')),
  );
  const track = element(
    0xae,
    element(0xd7, unsigned(1)),
    element(0x73c5, unsigned(1)),
    element(0x83, unsigned(1)),
    element(0x86, text(codec)),
    element(0xe0, element(0xb0, unsigned(width)), element(0xba, unsigned(height))),
  );
  const segment = element(0x18538067, info, element(0x1654ae6b, track), ...clusters(frames));
  return flatten([header, segment]);
}
