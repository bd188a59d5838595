import { afterEach, describe, expect, it } from "vitest";
import { anothersLease } from "../../fleet/operatorLease";
import type { AccessView, LeaseView } from "../../protocol";
import { station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../../testing/renderPage";
import { GUARD_MS } from "../guard/GuardButton";
import { VehicleList } from "../vehicles/VehicleList";
import { AuthoritySection } from "./AuthoritySection";

const BOB: AccessView = {
  name: "bob",
  role: "operator",
  is_logged_in: true,
  urls: [],
  fingerprint: null,
};
const ANNAS: LeaseView = { person: "anna", age_s: 14, absent_s: null };

function detail(lease: LeaseView | null) {
  const { serial, name, authority } = vehicle(1);
  return () => (
    <AuthoritySection serial={serial ?? ""} name={name} authority={authority} lease={lease} />
  );
}

describe("the lease of another person", () => {
  it("is any but one's own; unknown counts as another's", () => {
    expect(anothersLease(null, BOB)).toBeNull();
    expect(anothersLease(ANNAS, BOB)).toBe(ANNAS);
    expect(anothersLease({ ...ANNAS, person: "bob" }, BOB)).toBeNull();
    expect(anothersLease(ANNAS, null)).toBe(ANNAS);
  });
});

describe("who operates a vehicle", () => {
  let page: RenderedPage;
  afterEach(() => page.dispose());

  function hold(name: string, forMs = GUARD_MS) {
    const button = find(page.root, `[aria-label^="${name}"]`);
    button.dispatchEvent(new PointerEvent("pointerdown", { button: 0, bubbles: true }));
    page.clock.advance(forMs);
  }

  it("is shown, with what the page's person may still do", () => {
    page = renderPage(detail(ANNAS), station([vehicle(1)]));
    page.nameAs(BOB);
    const text = page.root.textContent;
    expect(text).toContain("Operated by anna for 14 s");
    expect(text).toContain("Hover, return, land and all stop are accepted");
  });

  it("is taken over explicitly, after a hold", () => {
    page = renderPage(detail(ANNAS), station([vehicle(1)]));
    page.nameAs(BOB);
    hold("Take over from anna, hold 1.5 s: Alder", GUARD_MS - 1);
    expect(page.requests).toEqual([]);
    page.clock.advance(1);
    expect(page.requests).toEqual([{ authority: "operator", serial: "SN-001", takeOver: true }]);
  });

  it("changes nothing for the person who operates it", () => {
    page = renderPage(detail({ ...ANNAS, person: "bob" }), station([vehicle(1)]));
    page.nameAs(BOB);
    expect(page.root.textContent).toContain("Operated by bob (you)");
    expect(page.root.textContent).not.toContain("refused");
    expect(page.root.querySelector('[aria-label^="Take over"]')).toBeNull();
  });

  it("tells since when an absent person is gone", () => {
    page = renderPage(detail({ ...ANNAS, absent_s: 20 }), station([vehicle(1)]));
    expect(page.root.textContent).toContain("not connected for 20 s");
  });

  it("is in the list when it is another person", () => {
    const vehicles = [
      vehicle(1, { lease: ANNAS }),
      vehicle(2, { lease: { ...ANNAS, person: "bob" } }),
    ];
    page = renderPage(VehicleList, station(vehicles));
    page.nameAs(BOB);
    const rows = [...page.root.querySelectorAll("li.vehicle")].map((row) => row.textContent);
    expect(rows[0]).toContain("anna");
    expect(rows[1]).not.toContain("bob");
  });
});
