import { afterEach, describe, expect, it, vi } from "vitest";
import type { FlightFiguresView, FlightView } from "../../protocol";
import { station, vehicle } from "../../testing/fakeState";
import { find, findButton, type RenderedPage, renderPage, settled } from "../../testing/renderPage";
import { flightTime } from "../../text/flights";
import { FlightsPanel } from "./FlightsPanel";

let page: RenderedPage;
afterEach(() => page?.dispose());

const NAME = "flight-20250620T160412Z";

function flight(changes: Partial<FlightView> = {}): FlightView {
  return {
    name: NAME,
    size_bytes: 55_204_853,
    changed_at_unix_ms: 0,
    is_recording: false,
    ...changes,
  };
}

const FIGURES: FlightFiguresView = {
  record: `${NAME}.mcap`,
  site: "demo field",
  begin_utc: "2025-06-20T16:04:12.000Z",
  end_utc: "2025-06-20T16:20:08.000Z",
  vehicles: ["Alder", "<b>Birch"],
  surveys: ["north"],
  airborne_s: 1899,
  region_m2: 145_728,
  photographed_share: 1,
  sunlit_share: 0.9999,
  well_sunlit_share: 0.87,
  mean_sun_share: null,
  shade_maps: 97,
  shade_maps_of_the_region: 97,
  alarms: 2,
  trouble: "",
};

/** The panel after its list has come. */
async function show(flights: readonly FlightView[], figures: FlightFiguresView | string = FIGURES) {
  page = renderPage(FlightsPanel, station([vehicle(1)]));
  page.showFlights(flights, figures);
  await refresh();
}

async function refresh() {
  find(page.root, "[aria-label=Refresh]").click();
  await settled();
}

const button = (text: string) => findButton(page.root, text);

function press(text: string) {
  button(text).click();
}

describe("the list", () => {
  it("names flights by their time, and marks the one that is recorded", async () => {
    await show([flight({ name: "mine", is_recording: true }), flight()]);
    expect(button("2025-06-20 16:04").textContent).toContain("55.2 MB");
    expect(button("mine").textContent).toContain("recording");
    expect(flightTime("flight-20250620T160412Z-2")).toBe("2025-06-20 16:04 (2)");
    expect(flightTime("ground-20250620T160412Z")).toBe("2025-06-20 16:04, on the ground");
  });

  it("states that there are no records only when the station has answered so", async () => {
    const none = "No flight records in the station's folder.";
    page = renderPage(FlightsPanel, station([vehicle(1)]));
    expect(page.root.textContent).not.toContain(none);
    await settled();
    expect(page.root.textContent).toContain(none);
    page.showFlights("Station unreachable", FIGURES);
    await refresh();
    expect(page.root.textContent).toContain("Station unreachable");
    expect(page.root.textContent).not.toContain(none);
  });
});

describe("a flight", () => {
  it("shows its figures and its coverage", async () => {
    await show([flight()]);
    press("2025-06-20 16:04");
    await settled();
    const text = find(page.root, "[data-testid=flight]").textContent;
    expect(text).toContain("Alder, <b>Birch");
    expect(text).toContain("14.6\u00a0ha");
    expect(text).toContain("In sun on a photo99\u00a0%");
    expect(text).toContain("Mean sun on the region—");
    expect(find<HTMLImageElement>(page.root, "img").src).toMatch(/^blob:/);
    expect(page.requests).toEqual([{ flight: NAME }, { flight: NAME, file: "coverage.png" }]);
  });

  it("saves a file under the flight's name", async () => {
    await show([flight()]);
    press("2025-06-20 16:04");
    await settled();
    const names: string[] = [];
    const click = vi.spyOn(HTMLAnchorElement.prototype, "click").mockImplementation(function (
      this: HTMLAnchorElement,
    ) {
      names.push(this.download);
    });
    press("Surveys KML");
    await settled();
    click.mockRestore();
    expect(names).toEqual([`${NAME}-surveys.kml`]);
    press("Record MCAP");
    await settled();
    expect(page.root.textContent).toContain("no record in this test");
  });

  it("shows why there are no figures, and still offers files", async () => {
    await show([flight()], "its record has no place");
    press("2025-06-20 16:04");
    await settled();
    expect(page.root.textContent).toContain("its record has no place");
    expect(button("Tracks GPX").disabled).toBe(false);
    const click = vi.spyOn(HTMLAnchorElement.prototype, "click").mockImplementation(() => {});
    press("Tracks GPX");
    await settled();
    expect(click).toHaveBeenCalledOnce();
    click.mockRestore();
    expect(page.root.textContent).toContain("its record has no place");
  });

  it("shows neither problem nor files of one chosen before, and is read once", async () => {
    await show([flight(), flight({ name: "long" })]);
    press("2025-06-20 16:04");
    await settled();
    press("Record MCAP");
    press("long");
    await settled();
    expect(page.root.textContent).not.toContain("no record in this test");
    expect(find(page.root, "[data-testid=flight]").textContent).toContain("Alder");
    const asked = page.requests.length;
    await refresh();
    expect(page.requests).toHaveLength(asked);
  });

  it("offers a record neither while it grows nor when a browser cannot hold it", async () => {
    await show([flight({ is_recording: true }), flight({ name: "long", size_bytes: 4e10 })]);
    press("2025-06-20 16:04");
    await settled();
    expect(button("Record MCAP").disabled).toBe(true);
    expect(page.root.textContent).toContain("still being recorded");
    press("long");
    await settled();
    expect(button("Record MCAP").disabled).toBe(true);
    expect(page.root.textContent).toContain("copy it from the station's folder");
  });
});
