/// A page that talks to a running `tandem view` of the gearbox cell.

import { afterEach, beforeAll, describe, expect, it } from 'vitest';
import type { Page } from 'playwright-core';
import { frames, kPatience, missing, Pages, waitFor, type Watched } from './harness';

describe.skipIf(missing('TANDEM_URL'))('a served page', { timeout: kPatience }, () => {
  const pages = new Pages();
  let page: Watched;

  beforeAll(async () => {
    page = await pages.served('#paused&draft');
  }, kPatience);
  afterEach(() => expect(page.complaints.splice(0)).toEqual([]));

  const query = (tab: Page) => tab.getByLabel('Query', { exact: true });

  /** Presses Plan and says whether there is one. */
  async function plan(tab: Page): Promise<boolean> {
    await tab.getByRole('button', { name: 'Plan', exact: true }).click();
    await tab.locator('.result.good, .result.bad').waitFor();
    return (await tab.locator('.result.good').count()) > 0;
  }

  /** Shows the ends of the first query again, whatever was there before. */
  async function chooseFirst(tab: Page): Promise<void> {
    const ends = tab.waitForResponse((response) => response.url().includes('/api/query'));
    await query(tab).selectOption({ index: 1 });
    await ends;
    const again = tab.waitForResponse((response) => response.url().includes('/api/query'));
    await query(tab).selectOption({ index: 0 });
    await again;
    await tab.waitForFunction(() => window.tandem.duration === 0);
    // The page takes the room of plots that go.
    await tab.waitForFunction(() => {
      const [canvas, view] = [document.getElementById('stage')!, document.getElementById('view')!];
      return canvas.clientHeight === view.clientHeight && document.body.classList.contains('no-charts');
    });
    await frames(tab, 3);
  }

  it('plans a query and plays it', async () => {
    const { tab } = page;
    await query(tab).selectOption({ index: 0 });
    expect(await plan(tab), await tab.locator('.result').innerText()).toBe(true);
    expect(await tab.evaluate(() => window.tandem.duration)).toBeGreaterThan(0);
    expect(await tab.evaluate(() => window.tandem.playing)).toBe(true);
    await waitFor(tab, 0);
    expect(await tab.locator('#title p').textContent()).toBe(await query(tab).inputValue());
    await tab.keyboard.press('Space');
  });

  it('drags a goal and answers what comes of it', async () => {
    const { tab } = page;
    await chooseFirst(tab);
    await tab.getByRole('button', { name: /^Drag the goal of/ }).first().click();
    await frames(tab, 2);
    const handle = () => tab.evaluate(() => window.tandem.handle());
    const [x, y] = (await handle())!;
    const solved = tab.waitForResponse((response) => response.url().endsWith('/api/ik'));
    await tab.mouse.move(x, y - 30);  // On the upward arrow.
    await frames(tab, 2);
    await tab.mouse.down();
    for (const up of [40, 50, 60]) await tab.mouse.move(x, y - up);
    await tab.mouse.up();
    await solved;
    expect((await handle())![1]).toBeLessThan(y - 5);
    await plan(tab);
    expect(await tab.locator('.result').innerText()).not.toBe('');
    expect(await query(tab).inputValue()).toBe('');
    await tab.keyboard.press('Space');
  });

  it('shows a refusal in its place, at the end that it is about', async () => {
    const { tab } = page;
    await chooseFirst(tab);
    const ghost = () => tab.locator('[data-toggle="start"] input').isChecked();
    const refuse = async (touching: object[]) => {
      await tab.route('**/api/plan', (route) => route.fulfill({
        status: 422,
        json: { error: { code: 'infeasible', message: 'this end is in collision', touching } },
      }), { times: 1 });
      expect(await plan(tab)).toBe(false);
      page.complaints.splice(0, Infinity, ...page.complaints.filter((text) => !text.includes('422')));  // Chromium logs it.
      return tab.locator('.result').innerText();
    };
    const pair = (end: string, name: string) => ({ end, pair: name, distance: -0.0123, a: [0, 0, 1], b: [0, 0, 1.01] });
    expect(await refuse([pair('goal', 'a and b')])).toMatch(/this end is in collision\s+a and b: 12\.3 mm deep/);
    expect(await ghost()).toBe(false);
    const text = await refuse([pair('start', 'c and d'), pair('goal', 'a and b')]);
    expect(text).toMatch(/c and d: 12\.3 mm deep/);
    expect(text).not.toMatch(/a and b/);
    expect(await ghost()).toBe(true);
  });
});
