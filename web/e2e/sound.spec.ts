import { expect, test } from "@playwright/test";
import { fleetState } from "./fake/fleetState";
import { FakeStation } from "./fake/station";
import { openPanel } from "./openPanel";

interface Sounds {
  readonly tones_hz: number[];
  readonly spoken: string[];
}

test("31 pairs are one tone and one sentence, from the first press on", async ({ page }) => {
  // A browser with a voice that allows sound after the first press only; the tests' own has none, and Playwright
  // counts as a press.
  await page.addInitScript(() => {
    const sounds: Sounds = { tones_hz: [], spoken: [] };
    Object.assign(window, { sounds });
    const start = OscillatorNode.prototype.start;
    OscillatorNode.prototype.start = function (this: OscillatorNode, when?: number) {
      if (this.context.state === "running") sounds.tones_hz.push(this.frequency.value);
      start.call(this, when);
    };
    const pressed = new Promise<void>((resolve) => {
      window.addEventListener("keydown", () => resolve(), { capture: true, once: true });
      window.addEventListener("pointerdown", () => resolve(), { capture: true, once: true });
    });
    const resume = AudioContext.prototype.resume;
    AudioContext.prototype.resume = async function (this: AudioContext) {
      await pressed;
      return resume.call(this);
    };
    const voice = { lang: "en-GB", localService: true, default: true, name: "a", voiceURI: "a" };
    const synthesis = {
      speaking: false,
      getVoices: () => [voice],
      speak: ({ text }: { text: string }) => sounds.spoken.push(text),
      cancel: () => undefined,
      addEventListener: () => undefined,
    };
    Object.defineProperty(window, "speechSynthesis", { value: synthesis });
    Object.defineProperty(window, "SpeechSynthesisUtterance", {
      value: class {
        constructor(readonly text: string) {}
      },
    });
  });
  const sounds = () => page.evaluate(() => (window as unknown as { sounds: Sounds }).sounds);
  const fake = await FakeStation.behind(page, fleetState(64, 0));
  const timer = setInterval(() => fake.send(fleetState(64, 0)), 500);
  page.once("close", () => clearInterval(timer));
  await page.goto("/");
  await expect(page.locator("button.craft")).toHaveCount(64);
  const notice = page.getByRole("alert").filter({ hasText: "No sound for:" });
  await expect(notice).toContainText("Separation: 31 pairs");
  expect(await sounds()).toEqual({ tones_hz: [], spoken: [] });
  // Any press will do.
  await page.keyboard.press("f");
  await expect.poll(async () => (await sounds()).spoken[0]).toBe("Separation: 31 pairs");
  expect((await sounds()).tones_hz.slice(0, 2)).toEqual([740, 740]);
  await expect(notice).toHaveCount(0);
  await openPanel(page, "Alarms");
  await page.getByRole("button", { name: "Mute Separation" }).click();
  await expect(notice).toContainText("Separation: 31 pairs");
  await page.reload();
  await expect(page.getByRole("button", { name: "31 alarms, muted: Separation" })).toBeVisible();
  await notice.getByRole("button", { name: "Unmute" }).click();
  await expect.poll(async () => (await sounds()).spoken[0]).toBe("Separation: 31 pairs");
});
