import { expect, type Page } from "@playwright/test";

/** The page's three looks, by what the computer prefers and whether the sun's high contrast is on. */
export const LOOKS = [
  { name: "light", colorScheme: "light", sun: false },
  { name: "dark", colorScheme: "dark", sun: false },
  { name: "sun", colorScheme: "light", sun: true },
] as const;

export type Look = (typeof LOOKS)[number];

/** Gives the page, once it is open, the high contrast of `look` when that has it. */
export async function wear(page: Page, look: Look): Promise<void> {
  if (!look.sun) return;
  await page.keyboard.press("t");
  await expect(page.locator("html")).toHaveAttribute("data-theme", "sun");
}
