import { afterEach, describe, expect, it } from "vitest";
import type { StationState } from "../protocol";
import { alarm, command, link, station, vehicle } from "../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../testing/renderPage";
import { AlarmList } from "./alarms/AlarmList";
import { AlarmsButton } from "./bar/AlarmsButton";
import { ConnectionBanner } from "./bar/ConnectionBanner";
import { StatusButton } from "./bar/StatusButton";
import { TopBar } from "./bar/TopBar";
import { CommandList } from "./commands/CommandList";
import { factsOf } from "./detail/facts";
import { VehicleDetail } from "./detail/VehicleDetail";
import { LinkList } from "./links/LinkList";
import { StationPanel } from "./station/StationPanel";
import { VehicleList } from "./vehicles/VehicleList";

const HOSTILE = '<img src=x onerror="document.title=1"><script>1</script>\u202e';

let page: RenderedPage;
const show = (part: Parameters<typeof renderPage>[0], state: StationState | null) => {
  page = renderPage(part, state);
  return page.root;
};

afterEach(() => page.dispose());

describe("received text", () => {
  it("is displayed as text in every panel", () => {
    const one = vehicle(1, { serial: HOSTILE, name: HOSTILE, model: HOSTILE });
    const state = station([one], {
      alarms: [alarm(1, { text: HOSTILE, vehicle_name: HOSTILE })],
      commands: [command(1, { vehicle_name: HOSTILE, note: HOSTILE, issued_by: HOSTILE })],
      links: [link(1, { claimed_serial: HOSTILE, closed_reason: HOSTILE })],
    });
    const root = show(
      () => (
        <>
          <VehicleList />
          <VehicleDetail />
          <AlarmList />
          <CommandList />
          <LinkList />
          <StationPanel />
        </>
      ),
      state,
    );
    page.shared.selection.only(1);
    expect(root.querySelector("img, script")).toBeNull();
    expect(root.textContent?.split(HOSTILE).length).toBeGreaterThan(8);
  });
});

describe("the vehicle list", () => {
  it("marks simulated vehicles with a tag", () => {
    const root = show(VehicleList, station([vehicle(1), vehicle(2, { is_simulated: true })]));
    const tags = [...root.querySelectorAll("li")].map((row) => row.textContent?.includes("SIM"));
    expect(tags).toEqual([false, true]);
  });

  it("greys a vehicle with old telemetry and shows the age", () => {
    const root = show(VehicleList, station([vehicle(1, { telemetry_age_s: 0.2 })]));
    expect(find(root, ".vehicle").classList.contains("is-stale")).toBe(false);
    page.age(4);
    expect(find(root, ".vehicle").classList.contains("is-stale")).toBe(true);
    expect(find(root, ".vehicle-doing").textContent).toBe("Contact lost · 4.2 s");
  });

  it("shows unknown values as a dash, never as zero", () => {
    const unknown = { value: null, age_s: null };
    const velocity = { north_mps: null, east_mps: null, down_mps: null, age_s: null };
    const one = vehicle(1, {
      height_above_takeoff_m: unknown,
      battery_fraction: unknown,
      velocity_ned: velocity,
    });
    const root = show(VehicleList, station([one]));
    expect(find(root, ".vehicle-doing").textContent).toBe("Flying · — · —");
    expect(find(root, ".vehicle-battery").textContent).toBe("—");
  });

  it("selects one by its row and more by their checkboxes", () => {
    const root = show(VehicleList, station([vehicle(1), vehicle(2), vehicle(3)]));
    const rows = [...root.querySelectorAll<HTMLElement>(".vehicle-body")];
    rows[1]?.click();
    expect(page.shared.selection.keys()).toEqual([2]);
    root.querySelectorAll<HTMLElement>("input")[2]?.click();
    expect(page.shared.selection.keys()).toEqual([2, 3]);
    rows[0]?.click();
    expect(page.shared.selection.keys()).toEqual([1]);
  });

  it("shows the app address while no app is connected", () => {
    expect(show(VehicleList, station([])).textContent).toContain("127.0.0.1:3001");
  });
});

describe("before the first state", () => {
  it("lists are unknown, not empty", () => {
    const lists = () => (
      <>
        <VehicleList />
        <AlarmList />
        <CommandList />
        <LinkList />
      </>
    );
    const empty = [...show(lists, null).querySelectorAll(".panel-empty")];
    expect(empty.map((note) => note.textContent)).toEqual(
      Array(4).fill("No data from the station yet."),
    );
  });
});

describe("the facts of a vehicle", () => {
  it("state each height's datum and why a value is unknown", () => {
    page = renderPage(() => null, station([]));
    const facts = factsOf(
      vehicle(1, {
        wind_level: { value: null, age_s: 0.4 },
        mission_id: { value: null, age_s: null },
        waypoint_altitude: "unset",
      }),
    );
    const of = (name: string) => facts.find((fact) => fact.name === name);
    expect(of("Height above takeoff")?.text).toBe("45.0\u00a0m");
    expect(of("Altitude (WGS84, as reported)")?.text).toBe("331.4\u00a0m");
    expect(of("Wind level")).toMatchObject({ text: "—", why: "no valid value in telemetry" });
    expect(of("Mission id")).toMatchObject({ text: "—", why: "not received yet" });
    expect(of("Waypoint altitude")?.why).toContain("missions are refused");
  });
});

describe("alarms", () => {
  it("name the vehicle, are sorted worst first and can be acknowledged", () => {
    const alarms = [
      alarm(1),
      alarm(7, { severity: "critical", vehicle_name: "Cedar", text: "Lost." }),
    ];
    const root = show(AlarmList, station([vehicle(1)], { alarms }));
    const rows = [...root.querySelectorAll("li")].map((row) => row.textContent);
    expect(rows[0]).toContain("Cedar: Lost.");
    find(root, "button[aria-label='OK: acknowledge Cedar: Lost.']").click();
    expect(page.acknowledged).toEqual([7]);
  });

  it("that ended are collapsed, and bar and panel count those that are active", () => {
    const alarms = [
      alarm(1, { is_active: false, severity: "critical" }),
      alarm(2),
      alarm(3, { severity: "error", vehicle_name: "Cedar" }),
    ];
    const root = show(() => [AlarmsButton(), AlarmList()], station([vehicle(1)], { alarms }));
    expect(find(root, ".panel-count").textContent).toBe("2");
    expect(find(root, ".bar-alarms").getAttribute("aria-label")).toBe("2 alarms");
    const folded = find<HTMLDetailsElement>(root, "details.alarm-ended");
    expect(folded.open).toBe(false);
    expect(folded.textContent).toContain("Ended, not acknowledged: 1");
    expect(folded.querySelectorAll("li")).toHaveLength(1);
  });
});

describe("commands", () => {
  it("are listed newest first with their phases and the reason of a refusal", () => {
    const refused = command(9, {
      phase: "refused_by_station",
      rule: "flying",
      note: "on the ground",
    });
    const root = show(CommandList, station([], { commands: [refused, command(8)] }));
    const rows = [...root.querySelectorAll("[data-testid^=command-]")];
    expect(rows.map((row) => row.getAttribute("data-testid"))).toEqual(["command-9", "command-8"]);
    expect(rows[0]?.textContent).toContain("on the ground");
    expect(find(root, "[title]").title).toBe("Safety rule: flying");
    const phases = [...(rows[1]?.querySelectorAll(".command-history li") ?? [])].map(
      (item) => item.textContent,
    );
    expect(phases).toEqual([
      "queued +0.0 s",
      "sent +0.0 s",
      "acknowledged +0.2 s",
      "confirmed +2.6 s",
    ]);
  });

  it("keep the station's order and hide internal numbers", () => {
    const own = command(-5, { kind: "stick", issued_by: "station" });
    const received = { commands: [own, command(8), command(-4)] };
    const root = show(CommandList, station([], received));
    const rows = [...root.querySelectorAll("[data-testid^=command-]")];
    expect(rows.map((row) => row.getAttribute("data-testid"))).toEqual([
      "command--5",
      "command-8",
      "command--4",
    ]);
    expect(rows[0]?.textContent).toContain("Station, 9.0 s ago");
    expect(rows[1]?.textContent).toContain("A program, 9.0 s ago");
    expect(root.textContent).not.toContain("-5");
    page.receive(station([], { commands: [command(9), ...received.commands] }));
    expect(root.querySelector("li")?.getAttribute("data-testid")).toBe("command-9");
  });

  it("show each phase's note once", () => {
    const history = [
      { phase: "sent", age_s: 40, note: "" },
      { phase: "confirmed", age_s: 39.6, note: "telemetry shows it landing" },
      { phase: "confirmed", age_s: 7, note: "telemetry shows it on the ground" },
    ] as const;
    const note = "telemetry shows it on the ground";
    const landed = command(3, { kind: "land", age_s: 40, history: [...history], note });
    const root = show(CommandList, station([], { commands: [landed] }));
    const phases = [...root.querySelectorAll(".command-history li")].map(
      (item) => item.textContent,
    );
    expect(phases).toEqual([
      "sent +0.0 s",
      "confirmed +0.4 s (telemetry shows it landing)",
      "confirmed +33 s (telemetry shows it on the ground)",
    ]);
    expect(root.textContent?.split(note)).toHaveLength(2);
  });

  it("name the replacement of an order once", () => {
    const note = "Replaced by order 4";
    const replaced = [{ phase: "superseded", age_s: 7, note }] as const;
    const old = command(3, { phase: "superseded", age_s: 40, history: [...replaced], note });
    const root = show(CommandList, station([], { commands: [old] }));
    const phase = root.querySelector(".command-history li");
    expect(phase?.textContent).toBe("replaced +33 s (by a newer order)");
  });
});

describe("links", () => {
  it("list conflicts and unidentified ones first, with protocol errors", () => {
    const links = [
      link(1),
      link(2, { status: "unidentified", claimed_serial: null }),
      link(3, { status: "conflict", bad_hash: 2, bytes_skipped: 40 }),
    ];
    const rows = [...show(LinkList, station([], { links })).querySelectorAll("li")];
    expect(rows.map((row) => row.querySelector("strong")?.textContent)).toEqual([
      "Link 3",
      "Link 2",
      "Link 1",
    ]);
    expect(rows[0]?.textContent).toContain("2 bad checksum, 40 bytes skipped");
  });

  it("show the number of ignored answers if there are any", () => {
    const root = show(LinkList, station([], { links: [link(1)] }));
    expect(root.textContent).not.toContain("ignored");
    page.receive(station([], { links: [link(1, { ignored_answers: 2 })] }));
    expect(root.textContent).toContain("2 answers ignored");
  });

  it("are collapsed at first and stay open through new states", () => {
    const root = show(LinkList, station([], { links: [link(1), link(2, { bad_size: 1 })] }));
    const open = () => [...root.querySelectorAll("details")].map((details) => details.open);
    const lines = [...root.querySelectorAll("summary")].map((line) => line.textContent);
    expect(lines).toEqual(["Link 2SN-002faultsIdentified", "Link 1SN-001Identified"]);
    expect(open()).toEqual([false, false]);
    find<HTMLDetailsElement>(root, "details").open = true;
    page.receive(station([], { links: [link(1), link(2, { bad_size: 2 })] }));
    expect(open()).toEqual([true, false]);
    expect(find(root, "details").textContent).toContain("2 bad size");
  });
});

describe("a command", () => {
  it("shows its mission part and adjustments", () => {
    const repairs = ["waypoint 3 is 0.40 m from waypoint 2 and was merged into it"];
    const one = command(1, { kind: "mission", part: "part 2 of 3", repairs });
    const root = show(CommandList, station([], { commands: [one, command(2)] }));
    const [mission, other] = root.querySelectorAll("li.command");
    expect(mission?.textContent).toContain("part 2 of 3");
    expect(mission?.querySelector("details")?.textContent).toContain("merged into it");
    expect(other?.querySelector("details")).toBeNull();
  });

  it("shows the refusal's reason, with the rule as tooltip", () => {
    const note = "path crosses keep-out zone Barn";
    const one = command(1, {
      phase: "refused_by_station",
      rule: "keep_out",
      note,
      history: [{ phase: "refused_by_station", age_s: 3, note }],
    });
    const root = show(CommandList, station([], { commands: [one] }));
    expect(root.textContent).toContain("refused by station +");
    expect(root.textContent).toContain("(path crosses keep-out zone Barn)");
    expect(find(root, ".command-history").title).toBe("Safety rule: keep out");
  });
});

describe("the station", () => {
  it("shows refused connections and lost capture data if there are any", () => {
    const state = station([]);
    const root = show(StationPanel, state);
    expect(root.textContent).not.toMatch(/refused|Lost/);
    const lossy = { ...state.station, connections_refused: 3, capture_dropped_bytes: 2_500 };
    page.receive(station([], { station: lossy }));
    expect(root.textContent).toContain("Connections refused3");
    expect(root.textContent).toContain("Lost from raw capture2.5 kB");
  });

  it("shows the terrain source and the flight limits", () => {
    const state = station([]);
    const root = show(StationPanel, state);
    expect(root.textContent).toContain("Terrainassumed flat");
    expect(root.textContent).toContain("Max. height above ground120");
    expect(root.textContent).toContain("Max. distance from home1000");
    const site = state.site && { ...state.site, terrain: "model" as const };
    page.receive(station([], { site }));
    expect(root.textContent).toContain("Terrainelevation model");
  });
});

describe("the top bar", () => {
  it("shows the readiness label, and the reasons when pressed", () => {
    const root = show(StatusButton, station([vehicle(1)], { alarms: [alarm(1)] }));
    expect(find(root, "[data-testid=status-label]").textContent).toBe("Flying");
    expect(root.querySelector(".status-reasons")).toBeNull();
    find(root, ".status-button").click();
    expect(find(root, ".status-reasons").textContent).toContain(
      "Dogwood: Aircraft battery warning",
    );
  });

  it("marks a simulation, and a mix with real vehicles", () => {
    const simulated = vehicle(1, { is_simulated: true });
    const root = show(() => <TopBar onHelp={() => {}} />, station([simulated]));
    expect(find(root, ".bar-simulation").textContent).toBe("Simulation");
    page.receive(station([simulated, vehicle(2)]));
    expect(find(root, ".tag-simulated").textContent).toBe("Real and simulated mixed");
  });

  it("shows a banner while the connection is lost", () => {
    const root = show(ConnectionBanner, station([vehicle(1)]));
    expect(root.querySelector(".banner")).toBeNull();
    page.connect({ kind: "lost", reason: "No data from the station", attempt: 3 });
    page.age(12);
    expect(find(root, ".banner").textContent).toContain(
      "All data below is 12 s old. No data from the station; reconnecting (attempt 3).",
    );
    page.connect({ kind: "live" });
    expect(root.querySelector(".banner")).toBeNull();
  });
});
