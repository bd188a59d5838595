import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import type { Page } from "@playwright/test";
import type { Fault } from "./legibility";

/** The rules of WCAG 2.2, levels A and AA. */
const TAGS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"];
/** WCAG 2.5.3, off in axe by default: voice control presses a button by its visible text. */
const ADDED = { "label-content-name-mismatch": { enabled: true } };
/** Evaluated, for the station's pages forbid scripts of others. */
const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

/** What breaks a rule of WCAG 2.2 AA anywhere on the page; `only` names the rules, else all. */
export async function axeFaults(page: Page, only: string[] | null = null): Promise<Fault[]> {
  if (!(await page.evaluate(() => "axe" in window))) await page.evaluate(AXE);
  const options = {
    runOnly:
      only === null
        ? { type: "tag" as const, values: TAGS }
        : { type: "rule" as const, values: only },
    rules: only === null ? ADDED : {},
    resultTypes: ["violations" as const],
  };
  const found = await page.evaluate(async (options) => {
    const { axe } = window as unknown as { axe: typeof import("axe-core") };
    const { violations } = await axe.run(document, options);
    return violations.flatMap(({ id, nodes }) =>
      nodes.map(({ html, failureSummary }) => ({ id, html, failureSummary })),
    );
  }, options);
  // A symbol is where its vehicle is, maybe half covered; the list has the same button.
  const isSymbol = (id: string, html: string) =>
    id === "target-size" && html.includes('class="craft');
  return found
    .filter(({ id, html }) => !isSymbol(id, html))
    .map(({ id, html, failureSummary }) => `${id}: ${html} ${failureSummary}`);
}
