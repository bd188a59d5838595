import { afterEach, expect, it } from "vitest";
import { station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../../testing/renderPage";
import { PanelMenu } from "./PanelMenu";

let page: RenderedPage;
afterEach(() => page?.dispose());

it("closes on a choice, so that it does not lie over the panel, and the focus returns to it", () => {
  page = renderPage(() => <PanelMenu onHelp={() => {}} />, station([vehicle(1)]));
  const menu = find<HTMLButtonElement>(page.root, "button[aria-label='Menu']");
  document.body.append(page.root);
  menu.click();
  const timeline = [...page.root.querySelectorAll("button")].find(
    ({ textContent }) => textContent === "Timeline",
  );
  timeline?.click();
  expect(page.shared.panels.isOpen("timeline")).toBe(true);
  expect(menu.getAttribute("aria-expanded")).toBe("false");
  expect(document.activeElement).toBe(menu);
});
