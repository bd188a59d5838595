import { afterEach, describe, expect, it } from "vitest";
import type { WaitingAppView } from "../../protocol";
import { link, station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../../testing/renderPage";
import { GUARD_MS } from "../guard/GuardButton";
import { LinkList } from "./LinkList";

const WAITING: WaitingAppView = {
  serial: "SN-NEW",
  age_s: 12,
  reason: "its serial is not on the list",
  is_flying: true,
};

function waiting(changes: Partial<WaitingAppView> = {}) {
  const shown = { ...WAITING, ...changes };
  const waits = link(7, { status: "waiting", claimed_serial: null, waiting: shown });
  return station([vehicle(1)], { links: [link(1), waits] });
}

describe("an app that waits to be admitted", () => {
  let page: RenderedPage;
  afterEach(() => page.dispose());

  function hold(name: string, forMs = GUARD_MS) {
    const button = find(page.root, `[aria-label^="${name}"]`);
    button.dispatchEvent(new PointerEvent("pointerdown", { button: 0, bubbles: true }));
    page.clock.advance(forMs);
  }

  it("comes first, with its serial, its address and why it waits", () => {
    page = renderPage(LinkList, waiting());
    const text = find(page.root, "li").textContent;
    expect(text).toContain("Link 7");
    expect(text).toContain("Waiting");
    expect(text).toContain("SN-NEW from 192.168.1.27:57312");
    expect(text).toContain("its serial is not on the list");
    expect(text).toContain("Reports flight");
  });

  it("is admitted for good or for this run, after a hold", () => {
    page = renderPage(LinkList, waiting());
    hold("Admit, hold 1.5 s: SN-NEW for good", GUARD_MS - 1);
    expect(page.requests).toEqual([]);
    page.clock.advance(1);
    hold("Admit for this run, hold 1.5 s: SN-NEW until");
    expect(page.requests).toEqual([
      { admittedLink: 7, serial: "SN-NEW", lasting: "always" },
      { admittedLink: 7, serial: "SN-NEW", lasting: "session" },
    ]);
  });

  it("is not admitted when its serial changes during the hold", () => {
    page = renderPage(LinkList, waiting());
    hold("Admit, hold 1.5 s: SN-NEW for good", GUARD_MS / 2);
    page.receive(waiting({ serial: "SN-OTHER" }));
    page.clock.advance(GUARD_MS);
    expect(page.requests).toEqual([]);
  });

  it("can only be refused without a serial", () => {
    page = renderPage(LinkList, waiting({ serial: null, is_flying: null }));
    expect(
      find(page.root, '[aria-label^="Admit, hold 1.5 s: link 7 for"]').getAttribute(
        "aria-disabled",
      ),
    ).toBe("true");
    hold("Refuse for 5 min, hold 1.5 s: link 7");
    expect(page.requests).toEqual([{ refusedLink: 7 }]);
  });

  it("shows why the station did not admit it", async () => {
    page = renderPage(LinkList, waiting());
    page.answerRequestsWith({ accepted: false, rule: "pairing", reason: "Now another serial." });
    hold("Admit, hold 1.5 s: SN-NEW for good");
    await Promise.resolve();
    await Promise.resolve();
    expect(page.root.textContent).toContain("Now another serial.");
  });
});
