import { expect, type Page, test } from "@playwright/test";
import { station, vehicle } from "../src/testing/fakeState";
import { CHECKLIST, fencedState } from "./fake/fencedState";
import { FakeStation } from "./fake/station";
import { lock, unlock } from "./views";

/** Everything on the page that can have the focus, with what it is. */
function focusable(
  page: Page,
): Promise<readonly { readonly what: string; readonly text: boolean }[]> {
  return page.evaluate(() => {
    const selector = "a[href], button, input, select, textarea, summary, canvas, [tabindex]";
    const all = [...document.querySelectorAll<HTMLElement>(selector)];
    const shown = all.filter((one) => one.checkVisibility() && one.tabIndex >= 0);
    return shown.map((one, index) => {
      one.dataset["focusable"] = String(index);
      const isInput = one instanceof HTMLInputElement;
      const text =
        isInput && one.type === "text" && !["decimal", "numeric"].includes(one.inputMode);
      const type = isInput ? ` ${one.type}` : "";
      return { what: `${one.tagName.toLowerCase()}${type} ${one.className}`, text };
    });
  });
}

/** Presses all stop with each element in focus; returns those in which it did nothing. */
async function deaf(page: Page, fake: FakeStation): Promise<string[]> {
  const found: string[] = [];
  for (const [index, { what, text }] of (await focusable(page)).entries()) {
    const element = page.locator(`[data-focusable="${index}"]`);
    const isFocused = await element.focus({ timeout: 10_000 }).then(
      () => true,
      () => false,
    );
    // A notice may have gone meanwhile, and then has no focus.
    if (!isFocused && (await element.count()) === 0) continue;
    expect(isFocused, what).toBe(true);
    const before = fake.allStops;
    await page.keyboard.press(text ? "Alt+Shift+S" : "Shift+S");
    await expect
      .poll(() => fake.allStops, { timeout: 5_000 })
      .toBe(before + 1)
      .catch(() => found.push(what));
  }
  return found;
}

test("all stop works with every element of the page in focus", async ({ page }) => {
  const fake = await FakeStation.behind(page, fencedState(0));
  fake.preflight = CHECKLIST;
  await page.goto("/");
  await expect(page.locator("button.craft")).toHaveCount(4);
  await page.keyboard.press("1");
  await page.keyboard.press("g");
  await page.getByRole("button", { name: "Use map centre" }).click();
  const kinds = new Set((await focusable(page)).map(({ what }) => what.split(" ")[0]));
  for (const kind of ["button", "input", "canvas", "summary"]) expect(kinds).toContain(kind);
  expect(await deaf(page, fake)).toEqual([]);
  await lock(page);
  expect(await deaf(page, fake)).toEqual([]);
  const orders = fake.orders.length;
  await page.keyboard.press("Shift+H");
  await page.locator(".page").click({ position: { x: 600, y: 420 } });
  await page.keyboard.press("2");
  await unlock(page);
  await expect(page.locator(".vehicle.is-selected")).toHaveText(/Alder/);
  expect(fake.orders).toHaveLength(orders);
  // Inside the help, and with a form of every kind of field.
  await page.keyboard.press("?");
  await page.evaluate(() => {
    const form = document.createElement("dialog");
    const types = ["radio", "range", "number", "checkbox", "date", "time", "color", "file", "text"];
    form.innerHTML = `${types.map((type) => `<input type="${type}">`).join("")}
      <select><option>Short</option><option>Salt</option></select><a href="#x">link</a>`;
    document.body.append(form);
    form.showModal();
  });
  for (const type of ["radio", "range", "number", "checkbox", "date", "time", "color", "file"]) {
    const before = fake.allStops;
    await page.locator(`dialog input[type=${type}]`).focus();
    await page.keyboard.press("Shift+S");
    await expect.poll(() => fake.allStops, type).toBe(before + 1);
  }
  for (const name of ["select", "a"]) {
    const before = fake.allStops;
    await page.locator(`dialog ${name}`).last().focus();
    await page.keyboard.press("Shift+S");
    await expect.poll(() => fake.allStops, name).toBe(before + 1);
  }
  const text = page.locator("dialog input[type=text]");
  await text.focus();
  const before = fake.allStops;
  await page.keyboard.press("Shift+S");
  await expect(text).toHaveValue("S");
  await page.keyboard.press("Alt+Shift+S");
  await expect.poll(() => fake.allStops).toBe(before + 1);
  await expect(text).toHaveValue("S");
});

test("all stop works with the focus in the login dialog", async ({ page }) => {
  const fake = await FakeStation.behind(page, station([vehicle(1)]));
  await page.routeWebSocket(/\/api\/stream/, (socket) =>
    socket.close({ code: 4401, reason: "Token missing" }),
  );
  await page.goto("/");
  await expect(page.getByLabel("Token, or the whole address with it")).toBeFocused();
  await page.keyboard.press("Alt+Shift+S");
  await expect.poll(() => fake.allStops).toBe(1);
});

test("all stop stays pressed, names who stopped, and is released by a long press", async ({
  page,
}) => {
  const fake = await FakeStation.behind(page, station([vehicle(1)]));
  await page.goto("/");
  const button = page.getByRole("button", { name: /^All stop/ });
  await expect(button).toHaveAttribute("aria-pressed", "false");
  const latch = { by: "anna", age_s: 2, released: [] };
  const stopped = station([vehicle(1, { is_stopped: true })], { stop_latch: latch });
  fake.send(stopped);
  const timer = setInterval(() => fake.send(stopped), 200);
  await expect(button).toHaveAttribute("aria-pressed", "true");
  await expect(button).toContainText("in force");
  const card = page.getByRole("alert");
  await expect(card).toContainText("All stop in force by anna");
  await expect(card).toContainText("An operator or an administrator can release it");
  await page.getByRole("button", { name: /^Release all, .*Alder/ }).focus();
  await page.keyboard.down("Enter");
  await expect.poll(() => fake.requests).toEqual([["/api/all-stop/release", { serials: null }]]);
  await page.keyboard.up("Enter");
  // Another press stops again.
  await button.click();
  await expect.poll(() => fake.allStops).toBe(1);
  clearInterval(timer);
});
