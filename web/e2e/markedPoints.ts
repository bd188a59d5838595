import { expect, type Page } from "@playwright/test";

/** Freezes a frame, and marks the first surveyed point on it with the keyboard alone. */
export async function markOnePoint(page: Page): Promise<void> {
  const panel = page.getByRole("region", { name: "Calibrate camera", exact: true });
  await panel.getByRole("button", { name: "Freeze a frame" }).press("Enter");
  await panel.getByRole("button", { name: /^Use the site's/ }).press("Enter");
  await panel.getByRole("button", { name: "Mark frame centre" }).press("Enter");
  await panel.getByRole("button", { name: "GATE on the frame" }).press("Shift+ArrowRight");
  await expect(panel.getByText(/^RMS 2.3/)).toBeVisible();
}
