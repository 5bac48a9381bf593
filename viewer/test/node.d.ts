/// The little of Node that the browser test uses.

declare const process: { env: Record<string, string | undefined>; cwd(): string };
declare module 'node:fs' {
  export function existsSync(path: string): boolean;
}
declare module 'node:path' {
  export function resolve(...parts: string[]): string;
}
declare module 'node:url' {
  export function pathToFileURL(path: string): URL;
}
