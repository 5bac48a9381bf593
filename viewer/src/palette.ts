/// How things look: the camera's angle, and colours that colour-blind people can tell apart. Ref: Okabe, Ito, Color Universal Design, 2008.

export type Theme = 'light' | 'dark';

export const kFieldOfView = 32;  // Upright [deg].

const okabeIto = {
  orange: '#e69f00',
  sky: '#56b4e9',
  green: '#009e73',
  yellow: '#f0e442',
  blue: '#0072b2',
  vermillion: '#d55e00',
  purple: '#cc79a7',
};

const arms: Record<Theme, string[]> = {
  light: [okabeIto.blue, okabeIto.orange, okabeIto.green, okabeIto.purple, okabeIto.sky],
  dark: [okabeIto.sky, okabeIto.orange, okabeIto.green, okabeIto.purple, okabeIto.blue],
};

/** The colour of an arm, everywhere. */
export function armColor(arm: number, theme: Theme): string {
  return arms[theme][arm % arms[theme].length];
}

export const colors = {
  clearance: { light: '#b0437f', dark: '#e58fbd' },  // Purple, readable on its ground.
  alert: { light: okabeIto.vermillion, dark: '#ff7a1a' },
  attached: { light: okabeIto.yellow, dark: okabeIto.yellow },
  background: { light: ['#f8fafc', '#d9e0e8'], dark: ['#20262e', '#0e1116'] },
  grid: { light: '#5b6b7d', dark: '#8fa3b8' },
  axes: [okabeIto.vermillion, okabeIto.green, okabeIto.blue] as [string, string, string],
} satisfies Record<string, unknown>;

/** Furniture: neutral, but one piece differs from the next. */
const furniture: Record<Theme, string[]> = {
  light: ['#aeb6bf', '#c9c3b8', '#93a0ad', '#bcc9d3', '#b3aca1', '#9db0b0'],
  dark: ['#6d7680', '#857f74', '#596673', '#7b8893', '#767065', '#637474'],
};

export function furnitureColor(index: number, theme: Theme): string {
  return furniture[theme][index % furniture[theme].length];
}

/** Modules of the planner, in the order they run. */
export const moduleColors: Record<string, string> = {
  path_planning: okabeIto.blue,
  simplification: okabeIto.sky,
  plpp: okabeIto.green,
  trajectory: okabeIto.orange,
  coordination: okabeIto.purple,
  certificate: okabeIto.vermillion,
  other: '#8b95a1',
};

/** Mixes two colours, `#rrggbb`; weight 0 gives a, 1 gives b. */
export function mix(a: string, b: string, weight: number): string {
  const channel = (color: string, i: number) => parseInt(color.slice(1 + 2 * i, 3 + 2 * i), 16);
  const mixed = [0, 1, 2].map((i) => Math.round((1 - weight) * channel(a, i) + weight * channel(b, i)));
  return `#${mixed.map((value) => value.toString(16).padStart(2, '0')).join('')}`;
}

/** The colour of one joint of an arm: its arm's hue, from the base (full) to the wrist (pale). */
export function jointColor(arm: number, joint: number, dof: number, theme: Theme): string {
  const weight = (0.55 * joint) / Math.max(dof - 1, 1);
  return mix(armColor(arm, theme), theme === 'light' ? '#c4ccd4' : '#3d4650', weight);
}
