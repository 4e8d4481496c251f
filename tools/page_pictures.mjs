// SPDX-License-Identifier: Apache-2.0
// Takes a picture of a page: page_pictures.mjs PAGE.html PICTURE.jpg [QUESTION.rq [ROW]] [dark] [home] [visits]. With a
// question, its answer is lit; with a row, its object is selected; home: the whole map is shown then; visits: what the last
// visit found changed, from above.
import { createRequire } from 'node:module';

const { chromium } = createRequire(new URL('../web/package.json', import.meta.url))('playwright-core');
const [file, picture, ...rest] = process.argv.slice(2);
const words = new Set(['dark', 'home', 'visits']), dark = rest.includes('dark');
const [question, row] = rest.filter((word) => !words.has(word));

const browser = await chromium.launch({
  executablePath: process.env.CLUXEL_CHROMIUM ?? '/usr/bin/chromium',
  args: ['--headless=new', '--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
const page = await browser.newPage({ viewport: { width: 1600, height: 900 }, colorScheme: dark ? 'dark' : 'light' });
const drawn = () => page.waitForFunction(() => window.cluxelPage?.viewer.isComplete && document.querySelector('.reading')?.hidden, null, { timeout: 120_000 });
await page.goto(`file://${file}`);
await drawn();
if (question) {
  await page.selectOption('#question', question);
  await page.waitForSelector('.answer tbody tr');
}
if (row) {
  await page.click(`.answer tbody tr:nth-child(${row})`);
  await page.waitForSelector('.why');
}
if (rest.includes('visits')) {
  await page.click('#tab-visits');
  await page.$eval('#visit', (slider) => {
    slider.value = slider.max;
    slider.dispatchEvent(new Event('input'));
  });
  await page.waitForSelector('.visit-kinds');
  await page.keyboard.press('t');
}
if (rest.includes('home')) await page.keyboard.press('h');
await page.waitForTimeout(300);
await drawn();
await page.mouse.move(700, 5);
await page.screenshot({ path: picture, ...(picture.endsWith('.png') ? {} : { type: 'jpeg', quality: 84 }) });
await browser.close();
