import type { Page } from "@playwright/test";

/** Description of a text or control that is too small or too faint. */
export type Fault = string;

/** Visible text smaller than 15 px. */
export function smallTexts(page: Page): Promise<Fault[]> {
  return page.evaluate(() => {
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    const faults: string[] = [];
    while (walker.nextNode()) {
      const element = walker.currentNode.parentElement;
      const text = walker.currentNode.textContent?.trim() ?? "";
      if (element === null || text === "" || !element.checkVisibility()) continue;
      const size = Number.parseFloat(getComputedStyle(element).fontSize);
      if (size < 15) faults.push(`${size} px: ${text}`);
    }
    return faults;
  });
}

/** What can be pressed or typed in, smaller than 44 px in either direction; an input counts with its label. */
export function smallTargets(page: Page): Promise<Fault[]> {
  return page.evaluate(() => {
    const kinds = "button, input, select, textarea, summary, a[href], [role=button], [role=slider]";
    const targets = [...document.querySelectorAll<HTMLElement>(kinds)];
    return (
      targets
        // A row that has just moved has no size before it is drawn again.
        .filter((target) => target.checkVisibility({ contentVisibilityAuto: true }))
        .flatMap((target) => {
          const { width, height } = (target.closest("label") ?? target).getBoundingClientRect();
          const name = target.getAttribute("aria-label") ?? target.textContent;
          return width < 44 || height < 44 ? [`${width} x ${height}: ${name}`] : [];
        })
    );
  });
}

/** Text whose contrast with its background is below 4.5 to 1 (WCAG 2, level AA). */
export function faintTexts(page: Page): Promise<Fault[]> {
  return page.evaluate(() => {
    type Rgba = [number, number, number, number];
    const canvas = new OffscreenCanvas(1, 1);
    const pen = canvas.getContext("2d", { willReadFrequently: true });
    if (pen === null) throw new Error("No 2D canvas available.");
    const parse = (colour: string): Rgba => {
      pen.clearRect(0, 0, 1, 1);
      pen.fillStyle = colour;
      pen.fillRect(0, 0, 1, 1);
      const [r = 0, g = 0, b = 0, a = 0] = pen.getImageData(0, 0, 1, 1).data;
      return [r, g, b, a / 255];
    };
    const over = (top: Rgba, below: Rgba): Rgba => {
      const mix = (at: 0 | 1 | 2) => top[at] * top[3] + below[at] * (1 - top[3]);
      return [mix(0), mix(1), mix(2), 1];
    };
    const behind = (element: Element | null): Rgba => {
      if (element === null) return [255, 255, 255, 1];
      const own = parse(getComputedStyle(element).backgroundColor);
      return own[3] === 1 ? own : over(own, behind(element.parentElement));
    };
    const linear = (value: number) => {
      const part = value / 255;
      return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
    };
    const light = ([r, g, b]: Rgba) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
    const contrast = (a: Rgba, b: Rgba) =>
      (Math.max(light(a), light(b)) + 0.05) / (Math.min(light(a), light(b)) + 0.05);

    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    const faults = new Set<string>();
    while (walker.nextNode()) {
      const element = walker.currentNode.parentElement;
      const text = walker.currentNode.textContent?.trim() ?? "";
      if (element === null || text === "" || !element.checkVisibility()) continue;
      // Disabled orders are faint on purpose.
      if (element.closest("[aria-disabled=true], :disabled") !== null) continue;
      const ground = behind(element);
      const ratio = contrast(over(parse(getComputedStyle(element).color), ground), ground);
      if (ratio < 4.5) faults.add(`${ratio.toFixed(2)}: ${text} (.${element.className})`);
    }
    return [...faults];
  });
}
