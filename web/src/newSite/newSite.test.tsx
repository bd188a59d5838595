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
  /** What the station would make of each request. */
  layers: unknown[] = [];
  coords: GeolocationCoordinates | null = NOWHERE;
  isOpen = false;

  async fetch(path: string, init?: RequestInit): Promise<Response> {
    const [place = ""] = path.split("?");
    this.asked.push({ path, body: init?.body });
    if (place === "api/site/new/shapes") return json({ features: this.layers });
    const answer = this.answers[place]?.shift();
    if (answer === undefined) throw new TypeError("no connection");
    return answer();
  }

  async locate() {
    if (this.coords === null) throw new Error("denied");
    return { coords: this.coords };
  }

  /** The bodies of requests to a path, except those without one. */
  sent(path: string): Record<string, unknown>[] {
    const bodies = this.asked.filter((each) => each.path === path && each.body !== undefined);
    return bodies.map(({ body }) => JSON.parse(String(body)));
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

function slide(label: string, value: number) {
  const slider = input(label);
  slider.value = String(value);
  slider.dispatchEvent(new InputEvent("input", { bubbles: true }));
}

const shape = (name: string, geometry: unknown) => ({
  name,
  geometry,
  layer: null,
  properties: {},
});

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
    type("Height above", "450,5");
    type("Simulated drones", "2");
    type("Wind, m/s", "6");
    slide("Clouds", 65);
    await make();
    expect(browser.sent("api/site/new")).toEqual([
      {
        name: "north",
        latitude_deg: 47.1,
        longitude_deg: 8.6,
        ground_above_sea_level_m: 450.5,
        simulated_drones: 2,
        regions: [],
        margin_m: 30,
        cloud_cover_percent: 65,
        wind_mps: 6,
        wind_from_deg: 250,
      },
    ]);
    expect(browser.asked.filter(({ path }) => path === "api/state")).toHaveLength(3);
    expect(browser.isOpen).toBe(true);
  });

  it("sends metres of a height typed in feet", async () => {
    const unit = root.querySelector("select");
    if (unit === null) throw new Error("no choice of units");
    unit.value = "ft";
    unit.dispatchEvent(new Event("change", { bubbles: true }));
    type("latitude", "47.1, 8.6");
    type("Height above", "1000");
    browser.answers["api/site/new"] = [() => json(ACCEPTED)];
    await make();
    expect(browser.sent("api/site/new")[0]?.["ground_above_sea_level_m"]).toBe(304.8);
  });

  it("reports a station that does not start after all", async () => {
    browser.answers["api/site/new"] = [() => json(ACCEPTED)];
    type("latitude", "47.1, 8.6");
    type("Height above", "450");
    root.querySelector("form")?.dispatchEvent(new SubmitEvent("submit", { bubbles: true }));
    for (let turn = 0; turn < 500 && !notice()?.includes("did not start"); turn += 1)
      await settled();
    expect(notice()).toContain("did not start: see its terminal");
    expect(browser.isOpen).toBe(false);
  });

  it.each([
    ["latitude", "somewhere", "Place: expected latitude and longitude"],
    ["Height above", "high", "Height above sea level: expected a number"],
    ["Wind, m/s", "breezy", "Wind: expected a speed in m/s"],
    ["Simulated drones", "2.5", "Simulated drones: expected a whole number"],
  ])("refuses a wrong %s and sends nothing", async (label, text, sentence) => {
    type("latitude", "47.1, 8.6");
    type("Height above", "450");
    type(label, text);
    await make();
    expect(notice()).toContain(sentence);
    expect(browser.sent("api/site/new")).toEqual([]);
  });

  it("shows the station's refusal, and why it does not answer", async () => {
    type("latitude", "47.1, 8.6");
    type("Height above", "450");
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

  it("keeps the shapes of a file, with the boundary as far out as its slider says", async () => {
    browser.answers["api/site/import"] = [
      () => json({ reason: null, features: [shape("west", KML), shape("east", KML)] }),
    ];
    browser.layers = [{ layer: "boundary", geometry: KML, properties: {} }];
    await choose(new File(["kml"], "north field.kml"));
    expect(browser.asked.map(({ path }) => path)).toContain(
      "api/site/import?name=north%20field.kml&close_paths=false",
    );
    expect(document.activeElement).toBe(input("Height above"));
    expect(root.querySelector("svg .field-picture-boundary")).not.toBeNull();
    expect(root.textContent).not.toContain("latitude, longitude");
    input("west").click();
    slide("Boundary", 45);
    type("Height above", "450");
    await make();
    expect(notice()).toBe("Choose a field of the file.");
    input("east").click();
    browser.answers["api/site/new"] = [() => json(ACCEPTED)];
    await make();
    const [asked] = browser.sent("api/site/new");
    expect(asked).toMatchObject({
      latitude_deg: 47.15,
      longitude_deg: 8.6,
      margin_m: 45,
      regions: [{ name: "east", geometry: KML }],
    });
    expect(browser.sent("api/site/new/shapes").at(-1)).toMatchObject({ margin_m: 45 });
  });

  it("shows that it reads while it reads, and a file without a field", async () => {
    let end = (_: Response) => {};
    browser.answers["api/site/import"] = [
      () =>
        new Promise<Response>((resolve) => {
          end = resolve;
        }),
    ];
    await choose(new File(["kml"], "slow.kml"));
    expect(root.querySelector("[role=status]")?.textContent).toBe("Reading slow.kml");
    expect(root.querySelector("progress")).not.toBeNull();
    const point = { type: "Point", coordinates: [8.5, 47.1] };
    end(json({ reason: null, features: [shape("gate", point)] }));
    for (let turn = 0; turn < 4; turn += 1) await settled();
    expect(root.querySelector("progress")).toBeNull();
    expect(notice()).toContain("slow.kml has no field");
  });

  it("joins the ends of a path where a file has nothing else, and says so", async () => {
    browser.answers["api/site/import"] = [
      () => json({ reason: "only paths", has_open_paths: true, features: [] }),
      () => json({ reason: null, features: [shape("edge", KML)] }),
    ];
    await choose(new File(["gpx"], "edge.gpx"));
    expect(browser.asked.map(({ path }) => path)).toContain(
      "api/site/import?name=edge.gpx&close_paths=true",
    );
    expect(input("edge").checked).toBe(true);
    expect(notice()).toContain("its ends are joined");
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
