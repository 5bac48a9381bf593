/// Pictures for `tandem view --png` and `--webm`: the program opens the page at "#capture=...", and
/// the page sends back what it made, or why it could not.

async function make(wanted: URLSearchParams): Promise<Blob> {
  await window.tandem.ready;
  const number = (key: string) => Number.parseFloat(wanted.get(key) ?? '');
  const [width, height] = [number('width'), number('height')];
  if (wanted.get('capture') === 'webm') return window.tandem.record(number('fps'), 1, width, height);
  window.tandem.setTime(number('t'));
  return window.tandem.capture(width, height);
}

export async function captureIfAsked(): Promise<void> {
  const wanted = new URLSearchParams(location.hash.slice(1));
  if (!wanted.has('capture')) return;
  const body = await make(wanted).catch((error: Error) => new Blob([error.message], { type: 'text/plain' }));
  await fetch('/api/capture', { method: 'POST', body });
}
