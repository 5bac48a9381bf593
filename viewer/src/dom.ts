/// Small helpers for building the page.

type Attributes = Record<string, string | number | boolean | ((event: Event) => void)>;

/** Makes an element; attributes that start with "on" are listeners, `false` leaves one out. */
export function el<Tag extends keyof HTMLElementTagNameMap>(
  tag: Tag,
  attributes: Attributes = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[Tag] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function') element.addEventListener(name.slice(2), value);
    else if (value !== false) element.setAttribute(name, value === true ? '' : String(value));
  }
  element.append(...children);
  return element;
}

export function byId<Kind extends HTMLElement>(id: string): Kind {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no element #${id}`);
  return element as Kind;
}

const paths = {
  play: 'M7 4.5v15l12-7.5z',
  pause: 'M6.5 5h4v14h-4zM13.5 5h4v14h-4z',
  first: 'M6 5h2.5v14H6zM20 5v14L9.5 12z',
  loop: 'M17 3l4 4-4 4V8H8a3 3 0 0 0-3 3v1H3v-1a5 5 0 0 1 5-5h9zM7 21l-4-4 4-4v3h9a3 3 0 0 0 3-3v-1h2v1a5 5 0 0 1-5 5H7z',
  charts: 'M4 4h2v14h14v2H4zM8.3 15.3l4-5 3 2.6 4.4-6 1.5 1.2-5.6 7.7-3.1-2.7-2.6 3.3z',
  panels: 'M3 5h18v14H3zm11 2H5v10h9zm2 0v10h3V7z',
  theme: 'M12 3a9 9 0 1 0 0 18zm0-2a11 11 0 1 1 0 22 11 11 0 0 1 0-22z',
  help: 'M11 17h2v2h-2zm1-12a4 4 0 0 1 4 4c0 2.2-3 2.6-3 5h-2c0-3.2 3-3.4 3-5a2 2 0 1 0-4 0H8a4 4 0 0 1 4-4z',
  home: 'M12 3l9 8h-2.5v9h-5v-6h-3v6h-5v-9H3z',
};

export function icon(name: keyof typeof paths): SVGSVGElement {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', '0 0 24 24');
  svg.setAttribute('aria-hidden', 'true');
  const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
  path.setAttribute('d', paths[name]);
  path.setAttribute('fill-rule', 'evenodd');
  svg.append(path);
  return svg;
}

export function button(label: string, content: Node | string, press: () => void, shortcut = ''): HTMLButtonElement {
  const title = shortcut ? `${label} (${shortcut})` : label;
  return el('button', { type: 'button', 'aria-label': label, title, onclick: press }, content);
}

export function select<Value extends string>(
  label: string,
  options: [Value, string][],
  chosen: Value,
  change: (value: Value) => void,
): HTMLSelectElement {
  const list = options.map(([value, text]) => el('option', { value, selected: value === chosen }, text));
  const element = el('select', { 'aria-label': label, title: label }, ...list);
  element.addEventListener('change', () => change(element.value as Value));
  return element;
}

export function checkbox(label: Node | string, checked: boolean, change: (on: boolean) => void): HTMLLabelElement {
  const input = el('input', { type: 'checkbox', checked });
  input.addEventListener('change', () => change(input.checked));
  return el('label', { class: 'check' }, input, label);
}

/** A part of the side panel that folds. */
export function section(title: string, open: boolean, ...children: (Node | string)[]): HTMLDetailsElement {
  return el('details', { class: 'panel', open }, el('summary', {}, title), el('div', { class: 'body' }, ...children));
}
