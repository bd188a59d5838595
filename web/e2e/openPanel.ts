import type { Page } from "@playwright/test";

/** Opens a panel from the menu, unless it is open. */
export async function openPanel(page: Page, name: string): Promise<void> {
  await page.getByRole("button", { name: "Menu", exact: true }).click();
  const item = page
    .getByRole("region", { name: "Menu" })
    .getByRole("button", { name, exact: true });
  const isOpen = (await item.getAttribute("aria-pressed")) === "true";
  await (isOpen ? page.keyboard.press("Escape") : item.click());
}
