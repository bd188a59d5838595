import type { Page } from "@playwright/test";
import type { Fault } from "./legibility";

/** Faults of the all stop button: it must be fully visible in the upper right corner and large enough. */
export function cornerFaults(page: Page): Promise<Fault[]> {
  return page.evaluate(() => {
    const button = document.querySelector<HTMLElement>(".all-stop");
    if (button === null) return ["no all stop"];
    const box = button.getBoundingClientRect();
    const faults: string[] = [];
    const right = document.documentElement.clientWidth - box.right;
    if (right < 0 || right > 24) faults.push(`${right} px from the right edge`);
    if (box.top < 0 || box.top > 24) faults.push(`${box.top} px from the upper edge`);
    if (box.width < 100 || box.height < 44) faults.push(`${box.width} x ${box.height} px`);
    // Sixteen points inside: each must hit the button itself.
    for (const u of [0.2, 0.4, 0.6, 0.8]) {
      for (const v of [0.2, 0.4, 0.6, 0.8]) {
        const x = box.left + u * box.width;
        const hit = document.elementFromPoint(x, box.top + v * box.height);
        if (hit === null || !button.contains(hit)) faults.push(`covered by .${hit?.className}`);
      }
    }
    const text = [...button.children].find((part) => part.scrollWidth > button.clientWidth);
    if (text !== undefined) faults.push(`too narrow for "${text.textContent}"`);
    return faults;
  });
}

/** Elements matching `selector` that overlap each other or extend beyond the page. */
export function overlaps(page: Page, selector: string): Promise<Fault[]> {
  return page.evaluate((selector) => {
    const shown = [...document.querySelectorAll<HTMLElement>(selector)]
      .filter((element) => element.checkVisibility())
      .map((element) => ({ name: element.textContent, box: element.getBoundingClientRect() }));
    const outside = shown
      .filter(({ box }) => box.left < 0 || box.right > document.documentElement.clientWidth)
      .map(({ name }) => `${name} extends beyond the page`);
    const pairs = shown.flatMap((a, index) =>
      shown
        .slice(index + 1)
        .filter(
          (b) =>
            Math.min(a.box.right, b.box.right) - Math.max(a.box.left, b.box.left) > 0.5 &&
            Math.min(a.box.bottom, b.box.bottom) - Math.max(a.box.top, b.box.top) > 0.5,
        )
        .map((b) => `${a.name} overlaps ${b.name}`),
    );
    return [...outside, ...pairs];
  }, selector);
}
