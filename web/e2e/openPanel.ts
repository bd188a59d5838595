import type { Page } from "@playwright/test";

/** Opens a panel from the menu, unless it is open. */
export async function openPanel(page: Page, name: string): Promise<void> {
  await page.getByRole("button", { name: "Menu", exact: true }).click();
  const item = page
    .getByRole("region", { name: "Menu" })
    .getByRole("button", { name, exact: true });
  if ((await item.getAttribute("aria-pressed")) === "false") await item.click();
  await page.keyboard.press("Escape");
}
