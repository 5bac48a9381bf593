/// Pages in a real browser that draws in software, the same way everywhere.
/// Set by tests/viewer/page_test.py: TANDEM_PAGE, an exported plan of the gearbox cell; TANDEM_URL,
/// the address of a running `tandem view CELL`; TANDEM_SMALL_PAGE, an exported plan of
/// tests/viewer/cell with a fixed motion; CHROMIUM, a browser.

import { existsSync, readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { chromium, type Browser, type BrowserContextOptions, type Page } from 'playwright-core';
import { afterAll, beforeAll, expect } from 'vitest';
import type { PageData } from '../../src/types';

export const kPatience = 120_000;  // [ms] A machine may be busy; a test that hangs is rare.

const chrome = process.env.CHROMIUM ?? '/usr/bin/chromium';
const noBrowser = existsSync(chrome) ? '' : `there is no browser at ${chrome}`;
const file = (name: string) => (process.env[name] ? resolve(process.cwd(), process.env[name]!) : '');

export const address = process.env.TANDEM_URL ?? '';
export const exportedPage = file('TANDEM_PAGE');
export const smallPage = file('TANDEM_SMALL_PAGE');

/** Why tests that need `what` cannot run, also printed; empty if they can. */
export function missing(what: 'TANDEM_PAGE' | 'TANDEM_SMALL_PAGE' | 'TANDEM_URL'): string {
  const given = what === 'TANDEM_URL' ? Boolean(address) : existsSync(file(what));
  const reason = noBrowser || (given ? '' : `${what} is not set to what its name says`);
  if (reason) console.warn(`skipped: ${reason}`);
  return reason;
}

const flags = ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic',
  '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync',
  '--force-color-profile=srgb', '--font-render-hinting=none', '--disable-lcd-text'];

/** A tab whose complaints are collected. */
export interface Watched {
  tab: Page;
  complaints: string[];
}

/** One browser for a file of tests. */
export class Pages {
  private browser: Browser | null = null;

  constructor() {
    beforeAll(async () => {
      if (!noBrowser) this.browser = await chromium.launch({ executablePath: chrome, args: flags, timeout: kPatience });
    }, kPatience);
    afterAll(async () => this.browser?.close(), kPatience);
  }

  /** An exported page from disk, with the network off, drawn and ready. */
  async fromDisk(page: string, hash: string, options: BrowserContextOptions = {}): Promise<Watched> {
    return this.open(pathToFileURL(page).href + hash, /^(file|data|blob):/, options, true);
  }

  async served(hash: string): Promise<Watched> {
    return this.open(new URL(hash, address).href, new RegExp(`^(${new URL(address).origin}|data:|blob:)`), {}, false);
  }

  private async open(url: string, allowed: RegExp, options: BrowserContextOptions, offline: boolean): Promise<Watched> {
    const context = await this.browser!.newContext({
      viewport: { width: 840, height: 540 },
      deviceScaleFactor: 0.5,  // A quarter of the pixels: drawing in software is what takes the time.
      colorScheme: 'light',
      ...options,
    });
    context.setDefaultTimeout(kPatience / 2);
    await context.setOffline(offline);
    const tab = await context.newPage();
    const complaints: string[] = [];
    tab.on('console', (message) => {
      if (message.type() === 'error' || message.type() === 'warning') complaints.push(message.text());
    });
    tab.on('pageerror', (error) => complaints.push(error.message));
    tab.on('request', (request) => {
      if (!allowed.test(request.url())) complaints.push(`asked for ${request.url()}`);
    });
    await tab.goto(url);
    await tab.evaluate(() => window.tandem.ready);
    return { tab, complaints };
  }
}

export const time = (tab: Page): Promise<number> => tab.evaluate(() => window.tandem.time);

export async function waitFor(tab: Page, from: number): Promise<void> {
  await tab.waitForFunction((t) => window.tandem.time !== t, from);
}

/** Until the page has drawn `count` times. */
export async function frames(tab: Page, count: number): Promise<void> {
  await tab.evaluate(async (n) => {
    for (let i = 0; i < n; ++i) await new Promise(requestAnimationFrame);
  }, count);
}

/** The scene alone as a PNG. */
export async function picture(tab: Page, width: number, height: number): Promise<Buffer> {
  const text = await tab.evaluate(async ([w, h]) => {
    const bytes = new Uint8Array(await (await window.tandem.capture(w, h)).arrayBuffer());
    return btoa(bytes.reduce((all, byte) => all + String.fromCharCode(byte), ''));
  }, [width, height]);
  return Buffer.from(text, 'base64');
}

/** What an exported page carries, and the page around other data. */
export function pageData(page: string): { data: PageData; around(data: PageData): string } {
  const html = readFileSync(page, 'utf8');
  const open = '<script id="tandem-data" type="application/json">';
  const from = html.indexOf(open) + open.length;
  const to = html.indexOf('</script>', from);
  expect(from, `${page} carries data`).toBeGreaterThan(open.length);
  return {
    data: JSON.parse(html.slice(from, to)) as PageData,
    around: (data) => html.slice(0, from) + JSON.stringify(data).replaceAll('<', '\\u003c') + html.slice(to),
  };
}
