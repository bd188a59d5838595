import { render } from "solid-js/web";
import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { settled } from "../testing/renderPage";
import { chooseLengthUnit } from "../text/units";
import { NewSitePage } from "./NewSitePage";
import { type Browser, createNewSite } from "./newSite";

const NOWHERE: GeolocationCoordinates = {
  latitude: 41.9,
  longitude: -93.6,
  altitude: 273.6,
  accuracy: 5,
  altitudeAccuracy: 3,
  heading: null,
  speed: null,
  toJSON: () => null,
};
const KML = {
  type: "Polygon",
  coordinates: [
    [
      [8.5, 47.1],
      [8.7, 47.1],
      [8.7, 47.2],
      [8.5, 47.1],
    ],
  ],
};
const ACCEPTED = { accepted: true, rule: null, reason: null };

/** A browser whose station answers as listed, in turn, and the requests that it was sent. */
class FakeBrowser implements Browser {
  readonly asked: { path: string; body: unknown }[] = [];
  answers: Record<string, (() => Response | Promise<Response>)[]> = {
    "api/site/new": [() => json({ folder: "/fields/north", name: "north" })],
  };
  coords: GeolocationCoordinates | null = NOWHERE;
  isOpen = false;

  async fetch(path: string, init?: RequestInit): Promise<Response> {
    const [place = ""] = path.split("?");
    this.asked.push({ path, body: init?.body });
    const answer = this.answers[place]?.shift();
    if (answer === undefined) throw new TypeError("no connection");
    return answer();
  }

  async locate() {
    if (this.coords === null) throw new Error("denied");
    return { coords: this.coords };
  }

  async wait() {}

  openConsole() {
    this.isOpen = true;
  }
}

const json = (body: unknown, status = 200) => new Response(JSON.stringify(body), { status });

let browser: FakeBrowser;
let root: HTMLElement;
let dispose: () => void;

beforeEach(async () => {
  browser = new FakeBrowser();
  const newSite = createNewSite(browser);
  root = document.body.appendChild(document.createElement("div"));
  dispose = render(() => <NewSitePage newSite={newSite} />, root);
  await newSite.begin();
});

afterEach(() => {
  dispose();
  root.remove();
  chooseLengthUnit("m");
});

function input(label: string): HTMLInputElement {
  const labels = [...root.querySelectorAll("label")];
  const found = labels.find((each) => each.textContent?.includes(label))?.querySelector("input");
  if (!found) throw new Error(`no field ${label}`);
  return found;
}

function type(label: string, text: string) {
  const field = input(label);
  field.value = text;
  field.dispatchEvent(new InputEvent("input", { bubbles: true }));
}

async function make() {
  root.querySelector("form")?.dispatchEvent(new SubmitEvent("submit", { bubbles: true }));
  for (let turn = 0; turn < 6; turn += 1) await settled();
}

const notice = () => root.querySelector("[role=alert], [role=status]")?.textContent ?? null;

describe("the page that makes a site", () => {
  it("shows the folder and proposes its name", () => {
    expect(root.textContent).toContain("/fields/north");
    expect(input("Name").value).toBe("north");
  });

  it("sends what is typed, waits for the station, and opens the console", async () => {
    browser.answers["api/site/new"] = [() => json(ACCEPTED)];
    browser.answers["api/state"] = [
      () => json({ error: "Not Found" }, 404),
      () => Promise.reject(new TypeError("no connection")),
      () => json({}),
    ];
    type("latitude", "47.1, 8.6");
    type("Ground there", "450,5");
    type("Simulated drones", "2");
    await make();
    expect(JSON.parse(String(browser.asked[1]?.body))).toEqual({
      name: "north",
      latitude_deg: 47.1,
      longitude_deg: 8.6,
      ground_above_sea_level_m: 450.5,
      simulated_drones: 2,
    });
    expect(browser.asked.filter(({ path }) => path === "api/state")).toHaveLength(3);
    expect(browser.isOpen).toBe(true);
  });

  it("sends metres of a height typed in feet", async () => {
    chooseLengthUnit("ft");
    type("latitude", "47.1, 8.6");
    type("Ground there", "1000");
    browser.answers["api/site/new"] = [() => json(ACCEPTED)];
    await make();
    const body = JSON.parse(String(browser.asked[1]?.body)) as { ground_above_sea_level_m: number };
    expect(body.ground_above_sea_level_m).toBe(304.8);
  });

  it("reports a station that does not start after all", async () => {
    browser.answers["api/site/new"] = [() => json(ACCEPTED)];
    type("latitude", "47.1, 8.6");
    type("Ground there", "450");
    root.querySelector("form")?.dispatchEvent(new SubmitEvent("submit", { bubbles: true }));
    for (let turn = 0; turn < 500 && !notice()?.includes("did not start"); turn += 1)
      await settled();
    expect(notice()).toContain("did not start: see its terminal");
    expect(browser.isOpen).toBe(false);
  });

  it.each([
    ["latitude", "somewhere", "Place: expected latitude and longitude"],
    ["Ground there", "high", "Ground above sea level: expected a number"],
    ["Simulated drones", "2.5", "Simulated drones: expected a whole number"],
  ])("refuses a wrong %s and sends nothing", async (label, text, sentence) => {
    type("latitude", "47.1, 8.6");
    type("Ground there", "450");
    type(label, text);
    await make();
    expect(notice()).toContain(sentence);
    expect(browser.asked).toHaveLength(1);
  });

  it("shows the station's refusal, and why it does not answer", async () => {
    type("latitude", "47.1, 8.6");
    type("Ground there", "450");
    const reason = "/fields/north/site.toml exists already; choose another folder";
    browser.answers["api/site/new"] = [() => json({ accepted: false, rule: "site", reason })];
    await make();
    expect(notice()).toBe(reason);
    await make();
    expect(notice()).toContain("The station does not answer");
    browser.answers["api/site/new"] = [() => json({ error: "name: too long" }, 422)];
    await make();
    expect(notice()).toBe("name: too long");
  });

  it("takes the middle of a file's shapes for the place", async () => {
    browser.answers["api/site/import"] = [
      () => json({ reason: null, features: [{ geometry: KML }] }),
    ];
    await choose(new File(["kml"], "north field.kml"));
    expect(input("latitude").value).toBe("47.1500000, 8.6000000");
    expect(browser.asked[1]?.path).toBe("api/site/import?name=north%20field.kml");
    expect(notice()).toContain("Import its shapes later");
  });

  it("shows why a file is not read", async () => {
    browser.answers["api/site/import"] = [() => json({ reason: "x.kml: no shapes", features: [] })];
    await choose(new File([""], "x.kml"));
    expect(notice()).toBe("x.kml: no shapes");
    expect(input("latitude").value).toBe("");
  });

  it("takes the device's place, or reports that it has none", async () => {
    const here = [...root.querySelectorAll("button")].find((each) =>
      each.textContent?.includes("Where this device is"),
    );
    here?.click();
    await settled();
    expect(input("latitude").value).toBe("41.9000000, -93.6000000");
    browser.coords = null;
    await settled();
    here?.click();
    await settled();
    expect(notice()).toContain("This device does not know its place");
  });
});

async function choose(file: File) {
  const field = input("file");
  Object.defineProperty(field, "files", { value: [file], configurable: true });
  field.dispatchEvent(new Event("change", { bubbles: true }));
  for (let turn = 0; turn < 4; turn += 1) await settled();
}
