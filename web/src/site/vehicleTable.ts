import type { Accessor } from "solid-js";
import type { Outcome, SiteVehiclesResponse, SiteVehiclesView, SiteVehicleView } from "../protocol";
import type { Clock } from "../source/clock";
import type { SiteRequests } from "../source/siteRequests";
import { text } from "../text/catalogue";
import { type Answer, createSavedDraft, NO_REASON, type SavedDraft } from "./savedDraft";

/** `changes` is null after an undo, whose answer does not list them. */
type VehiclesAnswer = Omit<SiteVehiclesResponse, "rule" | "changes"> & {
  readonly changes: readonly string[] | null;
};

interface RowPlace {
  readonly row: number | null;
}

/** The site's vehicles, edited row by row. How they are loaded, checked and saved: `savedDraft.ts`. */
export interface VehicleTable extends SavedDraft<SiteVehiclesView, RowPlace> {
  readonly rows: Accessor<readonly SiteVehicleView[]>;
  /** Loads the vehicles, unless there are edits. */
  open(): Promise<void>;
  edit(index: number, change: Partial<SiteVehicleView>): void;
  /** Adds a row; a serial that stands in the table already adds none. */
  add(serial: string): void;
  remove(index: number): void;
}

export function createVehicleTable(site: SiteRequests, clock: Clock): VehicleTable {
  const draft = createSavedDraft(
    {
      load: site.vehicles,
      check: site.checkVehicles,
      save: site.saveVehicles,
      undoSaved: (before) => undone(site, before),
      request: (revision, rows: readonly SiteVehicleView[]) => ({ revision, vehicles: [...rows] }),
      answerOf,
      savedIn: (view: SiteVehiclesView) => view.vehicles,
      itemOf: (row) => row,
      isEdited: (row, before) => JSON.stringify(row) !== JSON.stringify(before),
      noPlace: { row: null },
    },
    clock,
  );
  const { items: rows, edit, saved, isChanged } = draft;
  return {
    ...draft,
    rows,
    open: async () => {
      if (saved() === null || !isChanged()) await draft.discard();
    },
    edit: (index, change) =>
      edit(rows().map((row, i) => (i === index ? { ...row, ...change } : row))),
    add: (serial) => {
      if (rows().some((row) => row.serial === serial)) return;
      const blank = { name: null, number: null, camera: null, waypoint_altitude: null };
      edit([...rows(), { serial, ...blank }]);
    },
    remove: (index) => edit(rows().filter((_, i) => i !== index)),
  };
}

/** Takes back the last save. Its answer is about the layers: the vehicles are loaded after it. */
async function undone(
  site: SiteRequests,
  before: SiteVehiclesView,
): Promise<Outcome<VehiclesAnswer>> {
  const outcome = await site.undo(before.revision);
  if (outcome.kind === "failed") return outcome;
  const { accepted, reason } = outcome.value;
  if (!accepted) return { kind: "failed", problem: text.draft.notUndone(reason ?? NO_REASON) };
  const found = await site.vehicles();
  const vehicles = found.kind === "answered" ? found.value : before;
  return { kind: "answered", value: { accepted, reason, row: null, changes: null, vehicles } };
}

function answerOf(answer: VehiclesAnswer): Answer<SiteVehiclesView, RowPlace> {
  const { accepted, reason, row, vehicles } = answer;
  const changes = answer.changes ?? [];
  const isNone = changes.length === 0;
  return {
    accepted,
    reason,
    place: { row },
    changes: isNone ? "" : text.siteVehicles.willChange(changes.join("; ")),
    changed: answer.changes && (isNone ? "" : text.siteVehicles.changed(changes.length)),
    view: vehicles,
  };
}
