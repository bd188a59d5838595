import { type Accessor, createMemo, createSignal } from "solid-js";
import type { Outcome, SiteVehiclesView } from "../protocol";
import type { Clock } from "../source/clock";
import { text } from "../text/catalogue";

/*
 * Theory of operation. A list of the site is loaded from the station with its revision, edited here, and saved as a
 * whole.
 *
 * - Check: CHECK_AFTER_MS after the last edit the station is asked to check the list, as it would at its start. It
 *   answers with one sentence, about one item if it can. An answer to an older list is dropped (`checks`).
 * - Requests: one at a time (`isBusy`). Another one meanwhile is ignored; checks and refreshes are no such requests.
 * - Save: sends the revision that was loaded; the station refuses a list of an older one. The saved list replaces
 *   the draft, unless it was edited meanwhile: then only the revision is new. An undo of the last save is the same.
 * - Discard: loads the list again, unless it was edited while the answer was awaited: those edits stay.
 * - Refresh: another part of the site was saved, so the revision is new. If the station's list is as it was loaded,
 *   edits stay, on the new revision. If not, it is loaded, but only where there are no edits: a list with edits keeps
 *   its revision, and the station will refuse it.
 */

const CHECK_AFTER_MS = 500;
export const NO_REASON = text.requests.noReason;

/** What the station's check has found. `Place`: the item a refusal is about. */
export type Verdict<Place> =
  | { readonly kind: "none" | "checking" }
  /** A sentence about what changes; empty when nothing does. */
  | { readonly kind: "accepted"; readonly text: string }
  | ({ readonly kind: "refused"; readonly text: string } & Place);

/** What became of the last request. */
export interface Notice {
  readonly about: "site" | "import";
  readonly text: string;
  readonly isProblem: boolean;
}

/** What every list is loaded with. */
type Loaded = Pick<SiteVehiclesView, "revision" | "locked_reason" | "undo">;

/** The station's answer to a check, a save or an undo. */
export interface Answer<View, Place> {
  readonly accepted: boolean;
  readonly reason: string | null;
  readonly place: Place;
  /** For the verdict: a sentence about what changes; empty when nothing does. */
  readonly changes: string;
  /** For the notice: what has changed; empty: nothing; null: unknown. */
  readonly changed: string | null;
  /** As saved; null after a check. */
  readonly view: View | null;
}

/** What is edited, and the requests for it. `Saved` is an item as the station sends it. */
export interface EditedList<View extends Loaded, Saved, Item, Place, Request, Response> {
  load(): Promise<Outcome<View>>;
  check(request: Request): Promise<Outcome<Response>>;
  save(request: Request): Promise<Outcome<Response>>;
  undoSaved(before: View): Promise<Outcome<Response>>;
  request(revision: string, items: readonly Item[]): Request;
  answerOf(response: Response, asked: readonly Item[]): Answer<View, Place>;
  savedIn(view: View): readonly Saved[];
  itemOf(saved: Saved): Item;
  isEdited(item: Item, saved: Saved | undefined): boolean;
  /** The place of a refusal that is about no item. */
  readonly noPlace: Place;
  /** False: edits are not checked now. */
  isChecked?(): boolean;
  /** An edit has begun that is not in the list yet. */
  isEditing?(): boolean;
  /** The list is about to be replaced by a loaded one. */
  onLoad?(): void;
}

/** What panels need of any draft. */
export interface SavedDraft<View, Place> {
  /** A request that changes or reads the site is under way. */
  readonly isBusy: Accessor<boolean>;
  /** As saved; null before it was loaded. */
  readonly saved: Accessor<View | null>;
  readonly isChanged: Accessor<boolean>;
  readonly verdict: Accessor<Verdict<Place>>;
  readonly notice: Accessor<Notice | null>;
  /** How often this page has saved or undone something here. */
  readonly saves: Accessor<number>;
  /** Forgets all edits, and loads the list again. */
  discard(): Promise<void>;
  /** Another part of the site was saved: edits stay, on the new revision. */
  refresh(): Promise<void>;
  /** Checks again: what is in the air has changed. */
  recheck(): void;
  save(): Promise<void>;
  undoSaved(): Promise<void>;
}

export function createSavedDraft<View extends Loaded, Saved, Item, Place, Request, Response>(
  list: EditedList<View, Saved, Item, Place, Request, Response>,
  clock: Clock,
) {
  const [isBusy, setBusy] = createSignal(false);
  const [saved, setSaved] = createSignal<View | null>(null);
  const [items, setItems] = createSignal<readonly Item[]>([]);
  const [verdict, setVerdict] = createSignal<Verdict<Place>>({ kind: "none" });
  const [notice, setNotice] = createSignal<Notice | null>(null);
  const [saves, setSaves] = createSignal(0);
  const isChanged = createMemo(() => {
    const [view, now] = [saved(), items()];
    const before = view === null ? [] : list.savedIn(view);
    return now.length !== before.length || now.some((item, i) => list.isEdited(item, before[i]));
  });
  const isEditedSince = (asked: readonly Item[]) =>
    items() !== asked || list.isEditing?.() === true;
  const request = () => list.request(saved()?.revision ?? "", items());
  let checks = 0;
  let cancelCheck = () => {};

  const checkSoon = () => {
    cancelCheck();
    const number = ++checks;
    const isWanted = isChanged() && saved()?.locked_reason === null && list.isChecked?.() !== false;
    setVerdict({ kind: isWanted ? "checking" : "none" });
    if (!isWanted) return;
    cancelCheck = clock.after(CHECK_AFTER_MS, async () => {
      const asked = items();
      const outcome = await list.check(request());
      if (number === checks) setVerdict(() => verdictOf(outcome, asked));
    });
  };
  const verdictOf = (outcome: Outcome<Response>, asked: readonly Item[]): Verdict<Place> => {
    if (outcome.kind === "failed") {
      return { kind: "refused", text: outcome.problem, ...list.noPlace };
    }
    const { accepted, reason, place, changes } = list.answerOf(outcome.value, asked);
    if (accepted) return { kind: "accepted", text: changes };
    return { kind: "refused", text: reason ?? NO_REASON, ...place };
  };
  const put = (next: readonly Item[]) => {
    setItems(next);
    checkSoon();
  };
  const load = (view: View) => {
    setSaved(() => view);
    list.onLoad?.();
    put(list.savedIn(view).map((one) => list.itemOf(one)));
  };
  const note = (words: string, isProblem: boolean, about: Notice["about"] = "site") => {
    setNotice({ about, text: words, isProblem });
  };
  /** One request at a time; `done` gets its answer, and the items when it was sent. */
  const ask = async <T>(
    send: () => Promise<Outcome<T>>,
    done: (answer: T, asked: readonly Item[]) => void,
    about?: Notice["about"],
  ) => {
    if (isBusy()) return;
    setBusy(true);
    setNotice(null);
    const asked = items();
    const outcome = await send();
    setBusy(false);
    if (outcome.kind === "answered") done(outcome.value, asked);
    else note(outcome.problem, true, about);
  };
  const take =
    (
      refused: (reason: string) => string,
      done: (changed: string | null, isEdited: boolean) => string,
    ) =>
    (answer: Response, asked: readonly Item[]) => {
      const { accepted, reason, view, changed } = list.answerOf(answer, asked);
      if (!accepted || view === null) {
        setVerdict(() => verdictOf({ kind: "answered", value: answer }, asked));
        note(refused(reason ?? NO_REASON), true);
        return;
      }
      setSaves(saves() + 1);
      const isEdited = isEditedSince(asked);
      if (isEdited) {
        setSaved(() => view);
        checkSoon();
      } else load(view);
      note(done(changed, isEdited), false);
    };

  return {
    isBusy,
    saved,
    items,
    isChanged,
    verdict,
    notice,
    saves,
    ask,
    note,
    checkSoon,
    /** Replaces the items and keeps the notice. */
    put,
    edit: (next: readonly Item[]) => {
      setNotice(null);
      put(next);
    },
    discard: () =>
      ask(list.load, (view, asked) => {
        if (isEditedSince(asked)) {
          note(text.draft.editedMeanwhile, true);
        } else load(view);
      }),
    refresh: async () => {
      const before = saved();
      if (before === null) return;
      const asked = items();
      const outcome = await list.load();
      if (outcome.kind === "failed" || saved() !== before) return;
      const { revision, locked_reason, undo } = outcome.value;
      const [found, known] = [list.savedIn(outcome.value), list.savedIn(before)];
      // The items of before stay: edits are known by them.
      if (JSON.stringify(found) === JSON.stringify(known)) {
        setSaved(() => ({ ...before, revision, locked_reason, undo }));
      } else if (!isChanged() && !isEditedSince(asked)) load(outcome.value);
    },
    recheck: () => {
      if (verdict().kind !== "none") checkSoon();
    },
    save: () => ask(() => list.save(request()), take(text.draft.notSaved, text.draft.saved)),
    undoSaved: async () => {
      const before = saved();
      if (before === null) return;
      await ask(
        () => list.undoSaved(before),
        take(text.draft.notUndone, (changed, isEdited) =>
          isEdited ? text.draft.undoneButEdited(changed) : text.draft.undone(changed),
        ),
      );
    },
  };
}
