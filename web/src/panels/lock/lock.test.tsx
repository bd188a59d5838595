import { afterEach, beforeEach, expect, it } from "vitest";
import { station, vehicle } from "../../testing/fakeState";
import { find, findButton, type RenderedPage, renderPage } from "../../testing/renderPage";
import { AllStop } from "../bar/TopBar";
import { LockButton, LockScreen } from "./LockScreen";

let page: RenderedPage;
beforeEach(() => {
  const guarded = () => (
    <>
      <div class="dock-left" />
      <div class="dock-right">
        <div class="survey" />
        <div class="alarms" />
      </div>
      <LockButton />
      <LockScreen />
      <AllStop />
    </>
  );
  page = renderPage(guarded, station([vehicle(1)]));
});
afterEach(() => page.dispose());

const isInert = (selector: string) => find(page.root, selector).inert === true;
const hold = (ms: number) => {
  const unlock = findButton(page.root, "Unlock");
  unlock.dispatchEvent(new PointerEvent("pointerdown", { bubbles: true, button: 0 }));
  page.clock.advance(ms);
  unlock.dispatchEvent(new PointerEvent("pointerup", { bubbles: true, button: 0 }));
};

it("guards all but all stop and the alarms, until it is unlocked by a held button", () => {
  findButton(page.root, "Lock the page").click();
  expect([".dock-left", ".survey", ".alarms", ".all-stop"].map(isInert)).toEqual([
    true,
    true,
    false,
    false,
  ]);
  find(page.root, ".all-stop").click();
  expect(page.allStops()).toBe(1);
  hold(1000);
  expect(page.shared.lock.isOn()).toBe(true);
  // Also without a connection.
  page.connect({ kind: "lost", reason: "gone", attempt: 1 });
  hold(1600);
  expect(page.shared.lock.isOn()).toBe(false);
  expect(isInert(".dock-left")).toBe(false);
});
