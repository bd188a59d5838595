import { type Accessor, createMemo, createSignal } from "solid-js";
import type { LonLat } from "../map/localGrid";
import type {
  ImportedFeatureView,
  LayerName,
  SiteDrawingResponse,
  SiteDrawingView,
} from "../protocol";
import type { Clock } from "../source/clock";
import type { SiteRequests } from "../source/siteRequests";
import type { Outcome } from "../source/stationSource";
import { capitalised, listNames } from "../text/names";
import {
  type Attribute,
  type DraftFeature,
  featureOf,
  LAYERS,
  type Ring,
  ringsOf,
  squareAround,
  viewOf,
} from "./siteFeatures";

/*
 * Theory of operation. The drawing is loaded from the station, edited here, and saved as a whole. Each edit
 * replaces the list of features, so undo and redo are earlier and later lists. After a pause the station is
 * asked to check the draft, as it would at its start, and answers with one sentence, about one feature if it
 * can. Saving sends the revision that was loaded: the station refuses a draft of an older one. The answer to a
 * save replaces the list, unless it was edited meanwhile: then only the revision is new.
 */

/** What a press on the map adds. `hole`: a hole of the selected feature instead of a new one. */
export interface Tool {
  readonly layer: LayerName;
  readonly hole: boolean;
}

export type Verdict =
  | { readonly kind: "none" }
  | { readonly kind: "checking" }
  | { readonly kind: "accepted"; readonly text: string }
  | { readonly kind: "refused"; readonly text: string; readonly featureId: number | null };

/** What became of the last request. */
export interface Notice {
  readonly about: "site" | "import";
  readonly text: string;
  readonly isProblem: boolean;
}

/** A feature of an imported file, and what it is to become; null: it is left out. */
export interface ImportChoice {
  readonly name: string;
  readonly rings: readonly Ring[];
  readonly isPoint: boolean;
  readonly layer: LayerName | null;
}

export interface SiteDraft {
  readonly isOn: Accessor<boolean>;
  /** A request that changes or reads the site is under way. */
  readonly isBusy: Accessor<boolean>;
  /** As saved; null before it was loaded. */
  readonly saved: Accessor<SiteDrawingView | null>;
  readonly features: Accessor<readonly DraftFeature[]>;
  readonly selected: Accessor<DraftFeature | null>;
  readonly tool: Accessor<Tool | null>;
  readonly isChanged: Accessor<boolean>;
  readonly canUndo: Accessor<boolean>;
  readonly canRedo: Accessor<boolean>;
  readonly verdict: Accessor<Verdict>;
  readonly notice: Accessor<Notice | null>;
  readonly imported: Accessor<readonly ImportChoice[]>;
  /** Opens the editor, with the site as it is unless there are edits; or closes it. */
  toggle(): Promise<void>;
  leave(): void;
  /** Puts the tool away, else ends the selection. Returns false when there was neither. */
  clear(): boolean;
  select(id: number | null): void;
  draw(tool: Tool | null): void;
  /** The map has drawn a ring with the tool in hand. */
  finish(ring: Ring): void;
  /** Adds a square, or a pad, without a pointer. */
  addAt(layer: LayerName, centre: LonLat, side_m: number): void;
  setRing(id: number, index: number, ring: Ring): void;
  /** Removes a hole, or with the outline the feature. */
  removeRing(id: number, index: number): void;
  setProperty(id: number, key: string, value: Attribute): void;
  undo(): void;
  redo(): void;
  /** Forgets all edits since the drawing was loaded, and loads it again. */
  discard(): Promise<void>;
  /** How often this page has saved or undone something here. */
  readonly saves: Accessor<number>;
  /** Another part of the site was saved: edits stay, on the new revision. */
  refresh(): Promise<void>;
  /** Checks again: what is in the air has changed. */
  recheck(): void;
  save(): Promise<void>;
  undoSaved(): Promise<void>;
  readFile(file: File): Promise<void>;
  choose(index: number, layer: LayerName | null): void;
  /** A press on an imported feature: it is taken, or left out. */
  takeOrLeave(index: number): void;
  addImported(): void;
  dropImported(): void;
}

const CHECK_AFTER_MS = 500;
const MOST_UNDONE = 100;
/** Features of a file that are all taken at first: of more, a few are wanted. */
const MOST_TAKEN = 20;
export const LEAST_CORNERS = 3;

/** `groundAltitude_m` is where a pad is put: a drawing has no heights. */
export function createSiteDraft(
  site: SiteRequests,
  clock: Clock,
  groundAltitude_m: () => number | null,
): SiteDraft {
  const [isOn, setOn] = createSignal(false);
  const [isBusy, setBusy] = createSignal(false);
  const [saved, setSaved] = createSignal<SiteDrawingView | null>(null);
  const [features, setFeatures] = createSignal<readonly DraftFeature[]>([]);
  const [past, setPast] = createSignal<readonly (readonly DraftFeature[])[]>([]);
  const [future, setFuture] = createSignal<readonly (readonly DraftFeature[])[]>([]);
  const [selectedId, setSelectedId] = createSignal<number | null>(null);
  const [tool, setTool] = createSignal<Tool | null>(null);
  const [saves, setSaves] = createSignal(0);
  const [verdict, setVerdict] = createSignal<Verdict>({ kind: "none" });
  const [notice, setNotice] = createSignal<Notice | null>(null);
  const [imported, setImported] = createSignal<readonly ImportChoice[]>([]);
  const selected = createMemo(() => features().find(({ id }) => id === selectedId()) ?? null);
  const isChanged = createMemo(() => {
    const before = saved()?.features ?? [];
    const now = features();
    return now.length !== before.length || now.some(({ unedited }, i) => unedited !== before[i]);
  });
  // A ring that is half drawn is no edit yet: an undo would take back the one before.
  const canUndo = () => tool() === null && past().length > 0;
  const canRedo = () => tool() === null && future().length > 0;
  let nextId = 1;
  let checks = 0;
  let cancelCheck = () => {};

  const show = (next: readonly DraftFeature[]) => {
    setFeatures(next);
    checkSoon();
  };
  const edit = (next: readonly DraftFeature[]) => {
    setPast([...past(), features()].slice(-MOST_UNDONE));
    setFuture([]);
    setNotice(null);
    show(next);
  };
  const editOne = (id: number, change: (one: DraftFeature) => Partial<DraftFeature>) =>
    edit(
      features().map((one) => (one.id === id ? { ...one, unedited: null, ...change(one) } : one)),
    );
  const created = (
    layer: LayerName,
    rings: readonly Ring[],
    name: string,
    beside: readonly DraftFeature[],
  ): DraftFeature => {
    const named = { name: name || freeName(layer, beside) };
    const properties =
      layer === "landing_pads" ? { ...named, altitude_m: groundAltitude_m() ?? 0 } : named;
    return { id: nextId++, layer, rings, properties, unedited: null };
  };
  const add = (layer: LayerName, rings: readonly Ring[]) => {
    const one = created(layer, rings, "", features());
    edit([...features(), one]);
    setSelectedId(one.id);
  };

  const request = () => ({
    revision: saved()?.revision ?? "",
    features: features().map(viewOf),
  });
  const checkSoon = () => {
    cancelCheck();
    checks += 1;
    const isWanted = isOn() && isChanged() && saved()?.locked_reason === null;
    setVerdict({ kind: isWanted ? "checking" : "none" });
    if (isWanted) cancelCheck = clock.after(CHECK_AFTER_MS, () => void check(checks));
  };
  const check = async (number: number) => {
    const asked = features();
    const outcome = await site.check(request());
    if (number === checks) setVerdict(verdictOf(outcome, asked));
  };

  const load = (view: SiteDrawingView) => {
    setSaved(view);
    setPast([]);
    setFuture([]);
    setSelectedId(null);
    show(view.features.map((one) => featureOf(nextId++, one)));
  };
  /** One request at a time; `done` gets its answer, and the features when it was asked. */
  const ask = async <T>(
    about: Notice["about"],
    send: () => Promise<Outcome<T>>,
    done: (answer: T, asked: readonly DraftFeature[]) => void,
  ) => {
    if (isBusy()) return;
    setBusy(true);
    setNotice(null);
    const asked = features();
    const outcome = await send();
    setBusy(false);
    if (outcome.kind === "answered") done(outcome.value, asked);
    else setNotice({ about, text: outcome.problem, isProblem: true });
  };
  /** An answer takes seconds: a draft that was edited meanwhile, or a ring half drawn, is kept. */
  const isEditedSince = (asked: readonly DraftFeature[]) => features() !== asked || tool() !== null;
  const loaded =
    (verb: string, ifEdited = "") =>
    (answer: SiteDrawingResponse, asked: readonly DraftFeature[]) => {
      if (!answer.accepted || answer.drawing === null) {
        setVerdict(verdictOf({ kind: "answered", value: answer }, asked));
        const text = `Not ${verb}: ${answer.reason ?? "no reason given"}`;
        setNotice({ about: "site", text, isProblem: true });
        return;
      }
      setSaves(saves() + 1);
      const isEdited = isEditedSince(asked);
      if (isEdited) {
        setSaved(answer.drawing);
        checkSoon();
      } else load(answer.drawing);
      const what = [layersText(answer.layers), ...answer.also]
        .filter((part) => part !== "")
        .join(", ");
      const changes = what === "" ? "nothing changes" : `${what}. In force now`;
      const rest = isEdited ? ifEdited : "";
      setNotice({
        about: "site",
        text: `${capitalised(verb)}: ${changes}${rest}`,
        isProblem: false,
      });
    };
  const reload = () =>
    ask(
      "site",
      () => site.drawing(),
      (view, asked) => {
        if (!isEditedSince(asked)) return load(view);
        const text = "Not loaded again: the draft was edited meanwhile";
        setNotice({ about: "site", text, isProblem: true });
      },
    );

  return {
    isOn,
    isBusy,
    saved,
    features,
    selected,
    tool,
    isChanged,
    canUndo,
    canRedo,
    verdict,
    notice,
    imported,
    toggle: async () => {
      setOn(!isOn());
      setTool(null);
      // A draft with edits is kept while the editor is closed; the station refuses it if it is out of date.
      if (isOn() && !isChanged()) await reload();
      else checkSoon();
    },
    leave: () => {
      setTool(null);
      setOn(false);
      checkSoon();
    },
    clear: () => {
      const had = isOn() && (tool() !== null || selectedId() !== null);
      if (tool() !== null) setTool(null);
      else if (had) setSelectedId(null);
      return had;
    },
    select: (id) => {
      setTool(null);
      setSelectedId(id);
    },
    draw: (next) => {
      if (next !== null && !next.hole) setSelectedId(null);
      setTool(next);
    },
    finish: (ring) => {
      const [used, target] = [tool(), selected()];
      setTool(null);
      if (used === null) return;
      if (!used.hole) add(used.layer, [ring]);
      else if (target !== null) editOne(target.id, ({ rings }) => ({ rings: [...rings, ring] }));
    },
    addAt: (layer, centre, side_m) => {
      setTool(null);
      const ring = LAYERS[layer].isPoint ? [centre] : squareAround(centre, side_m);
      add(layer, [ring]);
    },
    setRing: (id, index, ring) =>
      editOne(id, ({ rings }) => ({ rings: rings.map((one, i) => (i === index ? ring : one)) })),
    removeRing: (id, index) => {
      if (index === 0) edit(features().filter((one) => one.id !== id));
      else editOne(id, ({ rings }) => ({ rings: rings.filter((_, i) => i !== index) }));
    },
    setProperty: (id, key, value) =>
      editOne(id, ({ layer, properties }) => ({
        properties: withProperty(layer, properties, key, value),
      })),
    undo: () => {
      const last = past().at(-1);
      if (!canUndo() || last === undefined) return;
      setPast(past().slice(0, -1));
      setFuture([features(), ...future()]);
      show(last);
    },
    redo: () => {
      const [next, ...rest] = future();
      if (!canRedo() || next === undefined) return;
      setFuture(rest);
      setPast([...past(), features()]);
      show(next);
    },
    discard: () => {
      setTool(null);
      return reload();
    },
    saves,
    refresh: async () => {
      const before = saved();
      if (before === null) return;
      const asked = features();
      const outcome = await site.drawing();
      if (outcome.kind === "failed" || saved() !== before) return;
      const { revision, undo, features: found } = outcome.value;
      const isSame = JSON.stringify(found) === JSON.stringify(before.features);
      // The features of before, by which edits are known.
      if (isSame) setSaved({ ...before, revision, undo });
      else if (!isChanged() && !isEditedSince(asked)) load(outcome.value);
    },
    recheck: () => {
      if (verdict().kind !== "none") checkSoon();
    },
    save: () => ask("site", () => site.save(request()), loaded("saved")),
    undoSaved: () =>
      ask(
        "site",
        () => site.undo(saved()?.revision ?? ""),
        loaded("undone", ". This draft was edited meanwhile and still has what was undone"),
      ),
    readFile: (file) =>
      ask(
        "import",
        () => site.readFile(file),
        ({ features: found, left_out, reason }) => {
          if (reason !== null) {
            setNotice({ about: "import", text: reason, isProblem: true });
            return;
          }
          const left = left_out === 0 ? "" : `; ${left_out} neither polygon nor point, left out`;
          setNotice({
            about: "import",
            text: `${file.name}: ${found.length} read${left}`,
            isProblem: false,
          });
          setImported(choicesOf(found));
        },
      ),
    choose: (index, layer) =>
      setImported(imported().map((one, i) => (i === index ? { ...one, layer } : one))),
    takeOrLeave: (index) =>
      setImported(
        imported().map((one, i) =>
          i === index ? { ...one, layer: one.layer === null ? usualLayer(one) : null } : one,
        ),
      ),
    addImported: () => {
      let next = features();
      for (const { name, rings, layer } of imported()) {
        if (layer !== null) next = [...next, created(layer, rings, name, next)];
      }
      setImported([]);
      if (next !== features()) edit(next);
    },
    dropImported: () => setImported([]),
  };
}

function verdictOf(outcome: Outcome<SiteDrawingResponse>, asked: readonly DraftFeature[]): Verdict {
  if (outcome.kind === "failed") {
    return { kind: "refused", text: outcome.problem, featureId: null };
  }
  const { accepted, reason, feature, layers } = outcome.value;
  if (accepted) return { kind: "accepted", text: layersText(layers) };
  const featureId = feature === null ? null : (asked[feature]?.id ?? null);
  return { kind: "refused", text: reason ?? "no reason given", featureId };
}

/** The layers that change, in words. */
function layersText(layers: readonly LayerName[]): string {
  const many = (name: string) => (name === LAYERS.boundary.name ? name : `${name}s`);
  return listNames(layers.map((layer) => many(LAYERS[layer].name).toLowerCase()));
}

/** A name that no other feature of the layer has; the boundary needs none. */
function freeName(layer: LayerName, features: readonly DraftFeature[]): string {
  if (layer === "boundary") return "boundary";
  const known = new Set(features.map(({ properties }) => properties["name"]));
  const kind = LAYERS[layer].name.toLowerCase();
  let number = 1;
  while (known.has(`${kind} ${number}`)) number += 1;
  return `${kind} ${number}`;
}

/** The attributes with one set or, for null, removed. Heights need their datum, and a datum heights. */
function withProperty(
  layer: LayerName,
  before: DraftFeature["properties"],
  key: string,
  value: Attribute,
): Record<string, Attribute> {
  const next: Record<string, Attribute> = { ...before, [key]: value };
  if (LAYERS[layer].hasHeights) {
    const hasHeights = (next["floor_m"] ?? null) !== null || (next["ceiling_m"] ?? null) !== null;
    next["datum"] = hasHeights ? (next["datum"] ?? "ground") : null;
  }
  return Object.fromEntries(Object.entries(next).filter(([, one]) => one !== null));
}

/** What the features of a file become; of a file with many, none is taken until it is chosen. */
function choicesOf(found: readonly ImportedFeatureView[]): ImportChoice[] {
  return found.map(({ name, geometry }) => {
    const one = { name, rings: ringsOf(geometry), isPoint: geometry.type === "Point" };
    return { ...one, layer: found.length > MOST_TAKEN ? null : usualLayer(one) };
  });
}

function usualLayer({ isPoint }: Pick<ImportChoice, "isPoint">): LayerName {
  return isPoint ? "landing_pads" : "survey_regions";
}
