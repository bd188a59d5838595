import { createSignal } from "solid-js";
import { cornerOf, cornerText } from "../site/siteFeatures";
import { text } from "../text/catalogue";
import { metresOf, numberIn } from "../text/units";

/** What the page needs of its browser; the station answers at `api/` paths. */
export interface Browser {
  fetch(path: string, init?: RequestInit): Promise<Response>;
  /** Rejects where the device does not know its place, or may not say it. */
  locate(): Promise<{ readonly coords: GeolocationCoordinates }>;
  wait(ms: number): Promise<unknown>;
  openConsole(): void;
}

/** What is asked of a new site, as it is typed. */
export interface Fields {
  readonly name: string;
  /** Latitude and longitude in degrees. */
  readonly place: string;
  readonly groundHeight: string;
  readonly drones: string;
}

export type Notice = { readonly kind: "error" | "done"; readonly text: string };

type Position = readonly [lon: number, lat: number];
interface Shape {
  readonly geometry: { readonly coordinates: unknown };
}

const ASK_AGAIN_MS = 500;
/** Three times as long as a station takes to start on a slow computer. */
const STARTS_WITHIN_MS = 60_000;

export type NewSite = ReturnType<typeof createNewSite>;

/**
 * A site to be made: asks the station which folder it is for, finds the field's place, and has the site made. The station
 * then begins at the same address, and the console opens.
 */
export function createNewSite(browser: Browser) {
  const [folder, setFolder] = createSignal("");
  const [fields, setFields] = createSignal<Fields>({
    name: "",
    place: "",
    groundHeight: "",
    drones: "3",
  });
  const [notice, setNotice] = createSignal<Notice | null>(null);
  const [isBusy, setBusy] = createSignal(false);
  const change = (changed: Partial<Fields>) => setFields((before) => ({ ...before, ...changed }));
  const refuse = (why: string) => setNotice({ kind: "error", text: why });

  /** Runs one piece of work at a time; a problem becomes the notice. */
  const working = async (work: () => Promise<void>) => {
    setBusy(true);
    setNotice(null);
    try {
      await work();
    } catch (problem) {
      refuse(problem instanceof Error ? problem.message : String(problem));
    } finally {
      setBusy(false);
    }
  };

  const answer = async (path: string, init?: RequestInit): Promise<Record<string, unknown>> => {
    const response = await browser.fetch(path, init).catch(() => {
      throw new Error(text.newSite.noAnswer);
    });
    const body = (await response.json()) as Record<string, unknown>;
    if (!response.ok) throw new Error(String(body["error"] ?? response.statusText));
    return body;
  };

  const begin = () =>
    working(async () => {
      const about = await answer("api/site/new");
      setFolder(String(about["folder"]));
      change({ name: String(about["name"]) });
    });

  const readFile = (file: File) =>
    working(async () => {
      const read = await answer(`api/site/import?name=${encodeURIComponent(file.name)}`, {
        method: "POST",
        body: file,
      });
      const reason = read["reason"];
      if (typeof reason === "string") throw new Error(reason);
      const place = middleOf(read["features"] as readonly Shape[]);
      change({ place: cornerText(place) });
      setNotice({
        kind: "done",
        text: text.newSite.middleOf(file.name),
      });
    });

  const locate = () =>
    working(async () => {
      const found = await browser.locate().catch(() => {
        throw new Error(text.newSite.unknownPlace);
      });
      const { latitude, longitude } = found.coords;
      change({ place: cornerText({ lat: latitude, lon: longitude }) });
    });

  const make = () =>
    working(async () => {
      const made = await answer("api/site/new", {
        method: "POST",
        headers: { "Content-Type": "application/json" },
        body: JSON.stringify(asked(fields())),
      });
      if (made["accepted"] !== true) throw new Error(String(made["reason"]));
      setNotice({ kind: "done", text: text.newSite.made });
      await untilStarted();
      browser.openConsole();
    });

  const untilStarted = async () => {
    for (let waited_ms = 0; waited_ms < STARTS_WITHIN_MS; waited_ms += ASK_AGAIN_MS) {
      const response = await browser.fetch("api/state").catch(() => null);
      if (response?.ok === true) return;
      await browser.wait(ASK_AGAIN_MS);
    }
    throw new Error(text.newSite.notStarted);
  };

  return { folder, fields, change, notice, isBusy, begin, readFile, locate, make };
}

/** The request for a site; throws a sentence for what is no number. */
function asked(fields: Fields) {
  const place = cornerOf(fields.place);
  if (place === null) throw new Error(text.newSite.badPlace);
  const height = numberIn(fields.groundHeight);
  if (typeof height !== "number") throw new Error(text.newSite.badHeight);
  const drones = numberIn(fields.drones);
  if (typeof drones !== "number" || !Number.isInteger(drones))
    throw new Error(text.newSite.badDrones);
  return {
    name: fields.name,
    latitude_deg: place.lat,
    longitude_deg: place.lon,
    ground_above_sea_level_m: metresOf(height),
    simulated_drones: drones,
  };
}

/** The middle of the box around all shapes. */
function middleOf(shapes: readonly Shape[]) {
  const corners = shapes.flatMap(({ geometry }) => positions(geometry.coordinates));
  const lons = corners.map(([lon]) => lon);
  const lats = corners.map(([, lat]) => lat);
  const middle = (values: readonly number[]) => (Math.min(...values) + Math.max(...values)) / 2;
  return { lon: middle(lons), lat: middle(lats) };
}

/** All positions of GeoJSON coordinates, however deep. */
function positions(coordinates: unknown): Position[] {
  if (!Array.isArray(coordinates)) return [];
  const [lon, lat] = coordinates as readonly unknown[];
  if (typeof lon === "number" && typeof lat === "number") return [[lon, lat]];
  return coordinates.flatMap(positions);
}
