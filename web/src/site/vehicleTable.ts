import { type Accessor, createMemo, createSignal } from "solid-js";
import type { SiteVehiclesResponse, SiteVehiclesView, SiteVehicleView } from "../protocol";
import type { Clock } from "../source/clock";
import type { SiteRequests } from "../source/siteRequests";
import type { Outcome } from "../source/stationSource";
import { capitalised, plural } from "../text/names";

/*
 * Theory of operation. The site's vehicles are loaded from the station, edited here, and saved as a whole. After
 * a pause the station is asked to check the rows, as it would at its start, and answers with one sentence, about
 * one row if it can. Saving sends the revision that was loaded: the station refuses the rows of an older one. The
 * answer to a save replaces the rows, unless they were edited meanwhile: then only the revision is new.
 */

export type RowVerdict =
  | { readonly kind: "none" | "checking" }
  | { readonly kind: "accepted"; readonly changes: readonly string[] }
  | { readonly kind: "refused"; readonly text: string; readonly row: number | null };

export interface VehicleTable {
  readonly isBusy: Accessor<boolean>;
  /** As saved; null before it was loaded. */
  readonly saved: Accessor<SiteVehiclesView | null>;
  readonly rows: Accessor<readonly SiteVehicleView[]>;
  readonly isChanged: Accessor<boolean>;
  readonly verdict: Accessor<RowVerdict>;
  /** What became of the last request. */
  readonly notice: Accessor<{ readonly text: string; readonly isProblem: boolean } | null>;
  /** Loads the vehicles, unless there are edits. */
  open(): Promise<void>;
  edit(index: number, change: Partial<SiteVehicleView>): void;
  /** Adds a row; a serial that stands in the table already adds none. */
  add(serial: string): void;
  remove(index: number): void;
  /** Forgets all edits, and loads the vehicles again. */
  discard(): Promise<void>;
  /** How often this page has saved or undone something here. */
  readonly saves: Accessor<number>;
  /** Another part of the site was saved: edits stay, on the new revision. */
  refresh(): Promise<void>;
  /** Checks again: what is in the air has changed. */
  recheck(): void;
  save(): Promise<void>;
  undoSaved(): Promise<void>;
}

const CHECK_AFTER_MS = 500;

export function createVehicleTable(site: SiteRequests, clock: Clock): VehicleTable {
  const [isBusy, setBusy] = createSignal(false);
  const [saved, setSaved] = createSignal<SiteVehiclesView | null>(null);
  const [rows, setRows] = createSignal<readonly SiteVehicleView[]>([]);
  const [saves, setSaves] = createSignal(0);
  const [verdict, setVerdict] = createSignal<RowVerdict>({ kind: "none" });
  const [notice, setNotice] = createSignal<{ text: string; isProblem: boolean } | null>(null);
  const isChanged = createMemo(
    () => JSON.stringify(rows()) !== JSON.stringify(saved()?.vehicles ?? []),
  );
  let checks = 0;
  let cancelCheck = () => {};

  const request = () => ({ revision: saved()?.revision ?? "", vehicles: [...rows()] });
  const checkSoon = () => {
    cancelCheck();
    checks += 1;
    const isWanted = isChanged() && saved()?.locked_reason === null;
    setVerdict({ kind: isWanted ? "checking" : "none" });
    if (isWanted) cancelCheck = clock.after(CHECK_AFTER_MS, () => void check(checks));
  };
  const check = async (number: number) => {
    const outcome = await site.checkVehicles(request());
    if (number === checks) setVerdict(verdictOf(outcome));
  };
  const set = (next: readonly SiteVehicleView[]) => {
    setNotice(null);
    setRows(next);
    checkSoon();
  };
  const load = (view: SiteVehiclesView) => {
    setSaved(view);
    setRows(view.vehicles);
    checkSoon();
  };
  /** One request at a time; `done` gets its answer, and the rows when it was asked. */
  const ask = async <T>(
    send: () => Promise<Outcome<T>>,
    done: (answer: T, asked: readonly SiteVehicleView[]) => void | Promise<void>,
  ) => {
    if (isBusy()) return;
    setBusy(true);
    setNotice(null);
    const asked = rows();
    const outcome = await send();
    setBusy(false);
    if (outcome.kind === "answered") await done(outcome.value, asked);
    else setNotice({ text: outcome.problem, isProblem: true });
  };
  const tell = (verb: string, reason: string | null, changes: number) => {
    const isProblem = reason !== null;
    const what = changes === 0 ? "nothing changes" : `${plural(changes, "vehicle")}. In force now`;
    const text = isProblem ? `Not ${verb}: ${reason}` : `${capitalised(verb)}: ${what}`;
    setNotice({ text, isProblem });
  };
  const reload = () => ask(() => site.vehicles(), load);

  return {
    isBusy,
    saved,
    rows,
    isChanged,
    verdict,
    notice,
    open: async () => {
      if (saved() === null || !isChanged()) await reload();
    },
    edit: (index, change) =>
      set(rows().map((row, i) => (i === index ? { ...row, ...change } : row))),
    add: (serial) => {
      if (rows().some((row) => row.serial === serial)) return;
      const blank = { name: null, number: null, camera: null, waypoint_altitude: null };
      set([...rows(), { serial, ...blank }]);
    },
    remove: (index) => set(rows().filter((_, i) => i !== index)),
    discard: reload,
    saves,
    refresh: async () => {
      const before = saved();
      if (before === null) return;
      const outcome = await site.vehicles();
      if (outcome.kind === "failed" || saved() !== before) return;
      const isSame = JSON.stringify(outcome.value.vehicles) === JSON.stringify(before.vehicles);
      if (!isChanged()) load(outcome.value);
      else if (isSame) setSaved(outcome.value);
    },
    recheck: () => {
      if (verdict().kind !== "none") checkSoon();
    },
    save: () =>
      ask(
        () => site.saveVehicles(request()),
        (answer, asked) => {
          if (!answer.accepted || answer.vehicles === null) {
            setVerdict(verdictOf({ kind: "answered", value: answer }));
            tell("saved", answer.reason ?? "no reason given", 0);
            return;
          }
          if (rows() === asked) load(answer.vehicles);
          else {
            setSaved(answer.vehicles);
            checkSoon();
          }
          tell("saved", null, answer.changes.length);
          setSaves(saves() + 1);
        },
      ),
    undoSaved: () =>
      ask(
        () => site.undo(saved()?.revision ?? ""),
        async (answer) => {
          if (!answer.accepted) return tell("undone", answer.reason ?? "no reason given", 0);
          await reload();
          setSaves(saves() + 1);
          setNotice({ text: "Undone. In force now", isProblem: false });
        },
      ),
  };
}

function verdictOf(outcome: Outcome<SiteVehiclesResponse>): RowVerdict {
  if (outcome.kind === "failed") return { kind: "refused", text: outcome.problem, row: null };
  const { accepted, reason, row, changes } = outcome.value;
  if (accepted) return { kind: "accepted", changes };
  return { kind: "refused", text: reason ?? "no reason given", row };
}
