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
import { text } from "../text/catalogue";
import { listNames } from "../text/names";
import { type Answer, createSavedDraft, type SavedDraft } from "./savedDraft";
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
 * Theory of operation. The drawing is loaded, checked and saved as `savedDraft.ts` describes. Each edit replaces
 * the list of features, so undo and redo are earlier and later lists. A ring that is half drawn is no edit yet, but
 * counts as one when an answer would replace the list. The draft is checked only while the editor is open.
 */

/** What a press on the map adds. `hole`: a hole of the selected feature instead of a new one. */
export interface Tool {
  readonly layer: LayerName;
  readonly hole: boolean;
}

/** The feature that a refusal is about. */
interface FeaturePlace {
  readonly featureId: number | null;
}

/** A feature of an imported file, and what it is to become; null: it is excluded. */
export interface ImportChoice {
  readonly name: string;
  readonly rings: readonly Ring[];
  readonly isPoint: boolean;
  readonly layer: LayerName | null;
  /** The layer that it is by its file, and its attributes there: a zone of an authority. */
  readonly ofFile: Pick<ImportedFeatureView, "layer" | "properties">;
}

/** The file that was read last: what is left out of it, and what is said about the rest. */
export interface FileReading {
  readonly file: File;
  readonly excluded: readonly string[];
  readonly warnings: readonly string[];
  /** False where nobody knows how far from their true place its shapes are. */
  readonly isFitForFences: boolean;
  /** Whether more of it is taken with its paths as areas. */
  readonly hasOpenPaths: boolean;
}

export interface SiteDraft extends SavedDraft<SiteDrawingView, FeaturePlace> {
  readonly isOn: Accessor<boolean>;
  readonly features: Accessor<readonly DraftFeature[]>;
  readonly selected: Accessor<DraftFeature | null>;
  readonly tool: Accessor<Tool | null>;
  readonly canUndo: Accessor<boolean>;
  readonly canRedo: Accessor<boolean>;
  readonly imported: Accessor<readonly ImportChoice[]>;
  readonly reading: Accessor<FileReading | null>;
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
  /** Reads a file; `closePaths` takes its paths as areas. */
  readFile(file: File, closePaths?: boolean): Promise<void>;
  choose(index: number, layer: LayerName | null): void;
  /** A press on an imported feature: it is taken, or excluded. */
  takeOrLeave(index: number): void;
  addImported(): void;
  dropImported(): void;
}

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
  const [past, setPast] = createSignal<readonly (readonly DraftFeature[])[]>([]);
  const [future, setFuture] = createSignal<readonly (readonly DraftFeature[])[]>([]);
  const [selectedId, setSelectedId] = createSignal<number | null>(null);
  const [tool, setTool] = createSignal<Tool | null>(null);
  const [imported, setImported] = createSignal<readonly ImportChoice[]>([]);
  const [reading, setReading] = createSignal<FileReading | null>(null);
  let nextId = 1;
  const draft = createSavedDraft(
    {
      load: site.drawing,
      check: site.check,
      save: site.save,
      undoSaved: ({ revision }) => site.undo(revision),
      request: (revision, items: readonly DraftFeature[]) => ({
        revision,
        features: items.map(viewOf),
      }),
      answerOf,
      savedIn: (view: SiteDrawingView) => view.features,
      itemOf: (one) => featureOf(nextId++, one),
      isEdited: ({ unedited }, before) => unedited !== before,
      noPlace: { featureId: null },
      isChecked: isOn,
      isEditing: () => tool() !== null,
      onLoad: () => {
        setPast([]);
        setFuture([]);
        setSelectedId(null);
      },
    },
    clock,
  );
  const { items: features, isChanged, checkSoon } = draft;
  const selected = createMemo(() => features().find(({ id }) => id === selectedId()) ?? null);
  // A ring that is half drawn is no edit yet: an undo would take back the one before.
  const canUndo = () => tool() === null && past().length > 0;
  const canRedo = () => tool() === null && future().length > 0;
  const edit = (next: readonly DraftFeature[]) => {
    setPast([...past(), features()].slice(-MOST_UNDONE));
    setFuture([]);
    draft.edit(next);
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

  return {
    ...draft,
    isOn,
    features,
    selected,
    tool,
    canUndo,
    canRedo,
    imported,
    toggle: async () => {
      setOn(!isOn());
      setTool(null);
      // A draft with edits is kept while the editor is closed; the station refuses it if it is out of date.
      if (isOn() && !isChanged()) await draft.discard();
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
      draft.put(last);
    },
    redo: () => {
      const [next, ...rest] = future();
      if (!canRedo() || next === undefined) return;
      setFuture(rest);
      setPast([...past(), features()]);
      draft.put(next);
    },
    discard: () => {
      setTool(null);
      return draft.discard();
    },
    reading,
    readFile: (file, closePaths = false) =>
      draft.ask(
        () => site.readFile(file, closePaths),
        ({ features: found, reason, ...said }) => {
          const { excluded, warnings, is_fit_for_fences, has_open_paths } = said;
          const isFit = { isFitForFences: is_fit_for_fences, hasOpenPaths: has_open_paths };
          setReading({ file, excluded, warnings, ...isFit });
          if (reason !== null) return draft.note(reason, true, "import");
          const { read, readSome } = text.imports;
          const note =
            excluded.length === 0
              ? read(file.name, found.length)
              : readSome(file.name, found.length, excluded.length);
          draft.note(note, false, "import");
          setImported(choicesOf(found));
        },
        "import",
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
      for (const { name, rings, layer, ofFile } of imported()) {
        if (layer === null) continue;
        const one = created(layer, rings, name, next);
        const more = ofFile.layer === layer ? ofFile.properties : {};
        next = [...next, { ...one, properties: { ...one.properties, ...more } }];
      }
      setImported([]);
      setReading(null);
      if (next !== features()) edit(next);
    },
    dropImported: () => {
      setImported([]);
      setReading(null);
    },
  };
}

function answerOf(
  response: SiteDrawingResponse,
  asked: readonly DraftFeature[],
): Answer<SiteDrawingView, FeaturePlace> {
  const { accepted, reason, feature, layers, also, drawing } = response;
  const changes = layersText(layers);
  return {
    accepted,
    reason,
    place: { featureId: feature === null ? null : (asked[feature]?.id ?? null) },
    changes: changes === "" ? "" : text.site.willChange(changes),
    changed: [changes, ...also].filter((part) => part !== "").join(", "),
    view: drawing,
  };
}

/** The layers that change, in words. */
function layersText(layers: readonly LayerName[]): string {
  return listNames(layers.map((layer) => text.siteLayers[layer].many));
}

/** A name that no other feature of the layer has; the boundary needs none. */
function freeName(layer: LayerName, features: readonly DraftFeature[]): string {
  const kind = text.siteLayers[layer].one;
  if (layer === "boundary") return kind;
  const known = new Set(features.map(({ properties }) => properties["name"]));
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
  return found.map(({ name, geometry, layer, properties }) => {
    const isPoint = geometry.type === "Point";
    const one = { name, rings: ringsOf(geometry), isPoint, ofFile: { layer, properties } };
    return { ...one, layer: found.length > MOST_TAKEN ? null : usualLayer(one) };
  });
}

function usualLayer({ isPoint, ofFile }: Pick<ImportChoice, "isPoint" | "ofFile">): LayerName {
  if (ofFile.layer !== null) return ofFile.layer;
  return isPoint ? "landing_pads" : "survey_regions";
}
