import { afterEach, describe, expect, it } from "vitest";
import type { SiteVehiclesResponse, SiteVehicleView } from "../../protocol";
import { station, vehicle } from "../../testing/fakeState";
import { find, findButton, type RenderedPage, renderPage, settled } from "../../testing/renderPage";
import { VehiclesPanel } from "./VehiclesPanel";

let page: RenderedPage;
afterEach(() => page?.dispose());

const ALDER: SiteVehicleView = {
  serial: "SN-001",
  name: "Alder",
  number: 1,
  camera: null,
  waypoint_altitude: "takeoff",
};
const NEW: SiteVehicleView = {
  serial: "NEW-9",
  name: null,
  number: null,
  camera: null,
  waypoint_altitude: null,
};
const ACCEPTED: SiteVehiclesResponse = {
  accepted: true,
  rule: null,
  reason: null,
  row: null,
  changes: ["SN-001 name Alder -> Ash"],
  vehicles: null,
};

async function open(rows: SiteVehicleView[], locked_reason: string | null = null) {
  page = renderPage(VehiclesPanel, station([vehicle(1), vehicle(2)]));
  await settled();
  const undo = { what: "vehicles", by: "anna (10.0.0.2)", utc: "2026-05-01T12:00:00Z" };
  page.site.vehicles = { revision: "r1", vehicles: rows, locked_reason, undo };
  await page.shared.vehicleTable.discard();
  await settled();
}

const button = (text: string) => findButton(page.root, text);
const field = (label: string) =>
  find<HTMLInputElement | HTMLSelectElement>(page.root, `[aria-label='${label}']`);

function type(label: string, text: string) {
  field(label).value = text;
  field(label).dispatchEvent(new Event("change", { bubbles: true }));
}

async function checked() {
  page.clock.advance(600);
  await settled();
}

describe("the table of the site's vehicles", () => {
  it("is edited, checked after a pause, and saved as a whole with its revision", async () => {
    await open([ALDER]);
    page.site.vehiclesResponse = ACCEPTED;
    expect(button("Save, in force at once").disabled).toBe(true);
    type("Name of SN-001", "Ash");
    type("Number of SN-001", "12");
    type("Altitude reference of SN-001", "wgs84");
    const edited = { ...ALDER, name: "Ash", number: 12, waypoint_altitude: "wgs84" as const };
    await checked();
    expect(page.site.askedVehicles).toEqual([["check", { revision: "r1", vehicles: [edited] }]]);
    expect(page.root.textContent).toContain("Ready to save: SN-001 name Alder -> Ash.");
    page.site.vehiclesResponse = {
      ...ACCEPTED,
      vehicles: { revision: "r2", vehicles: [edited], locked_reason: null, undo: null },
    };
    button("Save, in force at once").click();
    await settled();
    expect(page.site.askedVehicles.at(-1)).toEqual([
      "save",
      { revision: "r1", vehicles: [edited] },
    ]);
    expect(page.root.textContent).toContain("Saved: 1 vehicle. In force now");
    expect(page.shared.vehicleTable.isChanged()).toBe(false);
  });

  it("shows the station's sentence at the row that is wrong, and keeps what was typed", async () => {
    await open([ALDER, { ...ALDER, serial: "SN-002", name: "Birch", number: 2 }]);
    const reason = "Number: 1 is the number of Alder too";
    page.site.vehiclesResponse = { ...ACCEPTED, accepted: false, reason, row: 1, changes: [] };
    type("Number of SN-002", "1");
    await checked();
    const rows = page.root.querySelectorAll("tbody tr");
    expect(rows[0]?.textContent).not.toContain(reason);
    expect(rows[1]?.textContent).toContain(reason);
    expect(field("Number of SN-002").value).toBe("1");
  });

  it("takes no text for a number, and an empty one for the station's choice", async () => {
    await open([ALDER]);
    type("Number of SN-001", "one");
    expect(field("Number of SN-001").value).toBe("1");
    expect(page.shared.vehicleTable.isChanged()).toBe(false);
    type("Number of SN-001", " ");
    expect(page.shared.vehicleTable.rows()[0]?.number).toBe(null);
  });

  it("gets a row from a connected vehicle with one press, and from a serial once", async () => {
    await open([ALDER]);
    button("Add SN-002").click();
    const serials = () => page.shared.vehicleTable.rows().map(({ serial }) => serial);
    expect(serials()).toEqual(["SN-001", "SN-002"]);
    const serial = find<HTMLInputElement>(page.root, ".vehicle-add input");
    for (const text of ["NEW-9", "NEW-9"]) {
      serial.value = text;
      serial.dispatchEvent(new Event("input", { bubbles: true }));
      button("Add vehicle").click();
    }
    expect(serials()).toEqual(["SN-001", "SN-002", "NEW-9"]);
    expect(page.shared.vehicleTable.rows()[2]).toEqual(NEW);
    expect(page.root.querySelectorAll("tbody tr")[2]?.textContent).toContain("not connected");
    button("Remove SN-002").click();
    expect(serials()).toEqual(["SN-001", "NEW-9"]);
  });

  it("names what the last save was, and undoes it", async () => {
    await open([ALDER]);
    button("Undo last save: vehicles, by anna").click();
    await settled();
    expect(page.site.undone).toEqual(["r1"]);
    expect(page.root.textContent).toContain("Undone. In force now");
  });

  it("is locked where nothing can be saved, with the reason", async () => {
    await open([ALDER], "The demonstration's site is part of the program");
    type("Name of SN-001", "Ash");
    expect(button("Save, in force at once").disabled).toBe(true);
    expect(page.root.textContent).toContain("The demonstration's site is part of the program");
  });

  it("keeps its edits, on the new revision, when the layers are saved beside it", async () => {
    await open([ALDER]);
    type("Name of SN-001", "Ash");
    page.site.vehicles = { ...page.site.vehicles, revision: "r2" };
    await page.shared.vehicleTable.refresh();
    expect(page.shared.vehicleTable.rows()[0]?.name).toBe("Ash");
    expect(page.shared.vehicleTable.saved()?.revision).toBe("r2");
    // Vehicles that another screen has changed are not overwritten: the station refuses the old revision.
    page.site.vehicles = { ...page.site.vehicles, revision: "r3", vehicles: [] };
    await page.shared.vehicleTable.refresh();
    expect(page.shared.vehicleTable.saved()?.revision).toBe("r2");
  });

  it("keeps what is edited while it is loaded again, and states it", async () => {
    await open([ALDER]);
    const loading = page.shared.vehicleTable.discard();
    type("Name of SN-001", "Ash");
    await loading;
    expect(page.shared.vehicleTable.rows()[0]?.name).toBe("Ash");
    expect(page.root.textContent).toContain("Not loaded again: the draft was edited meanwhile");
  });

  it("keeps what is edited while a save is under way", async () => {
    await open([ALDER]);
    page.site.vehiclesResponse = {
      ...ACCEPTED,
      vehicles: { revision: "r2", vehicles: [ALDER], locked_reason: null, undo: null },
    };
    type("Name of SN-001", "Ash");
    const saving = page.shared.vehicleTable.save();
    type("Name of SN-001", "Aspen");
    await saving;
    expect(page.shared.vehicleTable.rows()[0]?.name).toBe("Aspen");
    expect(page.shared.vehicleTable.saved()?.revision).toBe("r2");
    expect(page.shared.vehicleTable.isChanged()).toBe(true);
  });
});
