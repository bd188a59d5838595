import { createSignal } from "solid-js";
import type { LonLat } from "../map/localGrid";
import type { DrawnFeatureView, ImportedView } from "../protocol";
import { cornerOf, cornerText, ringsOf } from "../site/siteFeatures";
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
  /** Latitude and longitude in degrees; of no use where a file has the field's shape. */
  readonly place: string;
  readonly groundHeight: string;
  readonly drones: string;
  /** Speed in m/s and where it comes from in degrees. */
  readonly wind: string;
  readonly windFrom: string;
  /** From the field to the boundary. */
  readonly margin_m: number;
  readonly cover_percent: number;
}

/** A polygon of a file. */
export interface FieldShape {
  readonly name: string;
  readonly geometry: DrawnFeatureView["geometry"];
  /** Whether it is a field to survey. */
  readonly isChosen: boolean;
}

export type Notice = { readonly kind: "error" | "done"; readonly text: string };

const ASK_AGAIN_MS = 500;
/** Far longer than a station takes to start, however busy the computer is. */
const STARTS_WITHIN_MS = 180_000;

export type NewSite = ReturnType<typeof createNewSite>;

/**
 * A site to be made: asks the station which folder it is for, finds the field's shape or place, shows the layers that
 * the station would make of it, and has the site made. The station then begins at the same address, and the console
 * opens.
 */
export function createNewSite(browser: Browser) {
  const [folder, setFolder] = createSignal("");
  const [fields, setFields] = createSignal<Fields>({
    name: "",
    place: "",
    groundHeight: "",
    drones: "3",
    wind: "3.5",
    windFrom: "250",
    margin_m: 30,
    cover_percent: 40,
  });
  const [shapes, setShapes] = createSignal<readonly FieldShape[]>([]);
  const [layers, setLayers] = createSignal<readonly DrawnFeatureView[]>([]);
  const [notice, setNotice] = createSignal<Notice | null>(null);
  const [busyWith, setBusyWith] = createSignal<string | null>(null);
  const refuse = (why: string) => setNotice({ kind: "error", text: why });

  /** Runs one piece of work at a time; a problem becomes the notice. */
  const working = async (what: string, work: () => Promise<void>) => {
    setBusyWith(what);
    setNotice(null);
    try {
      await work();
    } catch (problem) {
      refuse(problem instanceof Error ? problem.message : String(problem));
    } finally {
      setBusyWith(null);
    }
  };

  const answer = async <T>(path: string, init?: RequestInit): Promise<T> => {
    const response = await browser.fetch(path, init).catch(() => {
      throw new Error(text.newSite.noAnswer);
    });
    const body = await response.json();
    if (!response.ok) throw new Error(String(body["error"] ?? response.statusText));
    return body as T;
  };
  const post = <T>(path: string, body: unknown) =>
    answer<T>(path, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(body),
    });

  let isLooking = false;
  let isChanged = false;
  /** Shows the layers of what is asked for, the newest one of quick changes; nothing while that is incomplete. */
  const look = async () => {
    isChanged = true;
    if (isLooking) return;
    isLooking = true;
    while (isChanged) {
      isChanged = false;
      setLayers(await layersOf(fields(), shapes()).catch(() => []));
    }
    isLooking = false;
  };
  const layersOf = async (typed: Fields, chosen: readonly FieldShape[]) => {
    // The picture is flat: any height will do.
    const request = requestOf({ ...typed, groundHeight: "0" }, chosen);
    return (await post<{ features: DrawnFeatureView[] }>("api/site/new/shapes", request)).features;
  };

  const change = (changed: Partial<Fields>) => {
    setFields((before) => ({ ...before, ...changed }));
    void look();
  };
  const take = (found: readonly FieldShape[]) => {
    setShapes(found);
    void look();
  };
  const choose = (index: number, isChosen: boolean) =>
    take(shapes().map((shape, at) => (at === index ? { ...shape, isChosen } : shape)));

  const begin = () =>
    working(text.newSite.starting, async () => {
      const about = await answer<{ folder: string; name: string }>("api/site/new");
      setFolder(about.folder);
      change({ name: about.name });
    });

  const readFile = (file: File) =>
    working(text.newSite.reading(file.name), async () => {
      const name = encodeURIComponent(file.name.slice(-100));
      const ask = (closes: boolean) =>
        answer<ImportedView>(`api/site/import?name=${name}&close_paths=${closes}`, {
          method: "POST",
          body: file,
        });
      const first = await ask(false);
      // A track along the edge, with nothing else: its ends are joined.
      const isPath = first.reason !== null && first.has_open_paths;
      const read = isPath ? await ask(true) : first;
      if (read.reason !== null) throw new Error(read.reason);
      const polygons = read.features.filter(
        ({ geometry, layer }) =>
          geometry.type === "Polygon" && (layer ?? "survey_regions") === "survey_regions",
      );
      if (polygons.length === 0) throw new Error(text.newSite.noPolygon(file.name));
      take(polygons.map(({ name, geometry }, at) => ({ name, geometry, isChosen: at === 0 })));
      if (isPath) setNotice({ kind: "done", text: text.newSite.closed(file.name) });
    });

  const locate = () =>
    working(text.newSite.locating, async () => {
      const found = await browser.locate().catch(() => {
        throw new Error(text.newSite.unknownPlace);
      });
      const { latitude, longitude } = found.coords;
      take([]);
      change({ place: cornerText({ lat: latitude, lon: longitude }) });
    });

  const make = () =>
    working(text.newSite.making, async () => {
      const made = await post<{ accepted: boolean; reason: string | null }>(
        "api/site/new",
        requestOf(fields(), shapes()),
      );
      if (!made.accepted) throw new Error(String(made.reason));
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

  const forget = () => take([]);
  return {
    folder,
    fields,
    shapes,
    layers,
    notice,
    /** What the page waits for, as a sentence; null: nothing. */
    busyWith,
    change,
    choose,
    /** Goes back to a place without a shape. */
    forget,
    begin,
    readFile,
    locate,
    make,
  };
}

/** The request for a site; throws a sentence for what is no number. */
function requestOf(fields: Fields, shapes: readonly FieldShape[]) {
  const chosen = shapes.filter(({ isChosen }) => isChosen);
  if (shapes.length > 0 && chosen.length === 0) throw new Error(text.newSite.noneChosen);
  const place = chosen.length > 0 ? middleOf(chosen) : cornerOf(fields.place);
  if (place === null) throw new Error(text.newSite.badPlace);
  const drones = number(fields.drones, text.newSite.badDrones);
  if (!Number.isInteger(drones)) throw new Error(text.newSite.badDrones);
  return {
    name: fields.name,
    latitude_deg: place.lat,
    longitude_deg: place.lon,
    ground_above_sea_level_m: metresOf(number(fields.groundHeight, text.newSite.badHeight)),
    simulated_drones: drones,
    regions: chosen.map(({ name, geometry }) => ({ name, geometry })),
    margin_m: fields.margin_m,
    cloud_cover_percent: fields.cover_percent,
    wind_mps: number(fields.wind, text.newSite.badWind),
    wind_from_deg: number(fields.windFrom, text.newSite.badWind),
  };
}

function number(typed: string, problem: string): number {
  const value = numberIn(typed);
  if (value === null) throw new Error(problem);
  return value;
}

/** The middle of the box around all shapes, to a centimetre. */
function middleOf(shapes: readonly FieldShape[]): LonLat {
  const corners = shapes.flatMap(({ geometry }) => ringsOf(geometry).flat());
  const middle = (values: readonly number[]) => {
    const [least, most] = [Math.min(...values), Math.max(...values)];
    return Number(((least + most) / 2).toFixed(7));
  };
  return { lon: middle(corners.map(({ lon }) => lon)), lat: middle(corners.map(({ lat }) => lat)) };
}
