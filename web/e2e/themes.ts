import { expect, type Page, test } from "@playwright/test";

/** The page's three themes: the computer's colour scheme, and whether high contrast is on. */
export const THEMES = [
  { name: "light", colorScheme: "light", sun: false },
  { name: "dark", colorScheme: "dark", sun: false },
  { name: "sun", colorScheme: "light", sun: true },
] as const;

export type PageTheme = (typeof THEMES)[number];

/** Puts an open page through its themes, as one page: a new one takes seconds to draw its map. */
export async function inEachTheme(
  page: Page,
  look: (theme: PageTheme) => Promise<void>,
  names: readonly string[] = THEMES.map(({ name }) => name),
): Promise<void> {
  for (const theme of THEMES) {
    if (!names.includes(theme.name)) continue;
    await test.step(theme.name, async () => {
      await page.emulateMedia({ colorScheme: theme.colorScheme });
      await applyTheme(page, theme);
      await look(theme);
    });
  }
}

/** Switches an open page to high contrast if `theme` has it. */
export async function applyTheme(page: Page, theme: PageTheme): Promise<void> {
  if (!theme.sun) return;
  await page.keyboard.press("t");
  await expect(page.locator("html")).toHaveAttribute("data-theme", "sun");
}
