import { Show } from "solid-js";
import { useStation } from "../../console";
import type { Role, SiteVehiclesView } from "../../protocol";
import type { SavedDraft } from "../../site/savedDraft";
import type { SiteDraft } from "../../site/siteDraft";
import { text } from "../../text/catalogue";
import { personName } from "../../text/names";
import { Problem } from "../Panel";
import { NoticeLine } from "./NoticeLine";

/** What the check of a draft has found, and its save, discard and undo. */
export function SaveSection(props: {
  title: string;
  /** The verdict while the station checks. */
  checking: string;
  draft: SavedDraft<Pick<SiteVehiclesView, "locked_reason" | "undo">, object>;
  needs: Role;
  /** Whether a refusal stands at the item it is about, not here. */
  isElsewhere: boolean;
  /** Undo and redo of single edits, where there are such. */
  edits?: Pick<SiteDraft, "canUndo" | "canRedo" | "undo" | "redo">;
}) {
  const { lacks } = useStation();
  const { saved, isBusy, isChanged, verdict, notice } = props.draft;
  const locked = () => saved()?.locked_reason ?? lacks(props.needs);
  const general = () => {
    const now = verdict();
    return now.kind === "refused" && !props.isElsewhere ? now.text : null;
  };
  const Save = () => (
    <button
      type="button"
      class="button site-save"
      disabled={!isChanged() || isBusy() || locked() !== null}
      title={locked() ?? undefined}
      onClick={() => void props.draft.save()}
    >
      {text.draft.save}
    </button>
  );
  const Discard = () => (
    <button
      type="button"
      class="button"
      disabled={isBusy()}
      onClick={() => void props.draft.discard()}
    >
      {isChanged() ? text.draft.discard : text.draft.reload}
    </button>
  );
  return (
    <section class="section save-section" aria-label={props.title}>
      <Show when={props.edits}>
        {(edits) => (
          <div class="section-buttons">
            <button
              type="button"
              class="button"
              disabled={!edits().canUndo()}
              onClick={() => edits().undo()}
            >
              {text.draft.undo}
            </button>
            <button
              type="button"
              class="button"
              disabled={!edits().canRedo()}
              onClick={() => edits().redo()}
            >
              {text.draft.redo}
            </button>
            <Discard />
          </div>
        )}
      </Show>
      <p role="status" class="site-verdict">
        {verdictText()}
      </p>
      <Problem text={general()} />
      <Show when={props.edits === undefined} fallback={<Save />}>
        <div class="section-buttons">
          <Save />
          <Discard />
        </div>
      </Show>
      <NoticeLine notice={notice()?.about === "site" ? notice() : null} />
      <Show when={saved()?.undo}>
        {(change) => (
          <button
            type="button"
            class="button"
            disabled={isBusy() || isChanged() || locked() !== null}
            title={isChanged() ? text.draft.saveFirst : undefined}
            onClick={() => void props.draft.undoSaved()}
          >
            {text.draft.undoSave(change().what, personName(change().by))}
          </button>
        )}
      </Show>
    </section>
  );

  function verdictText(): string {
    const now = verdict();
    switch (now.kind) {
      case "none":
        return text.draft.noChanges;
      case "checking":
        return props.checking;
      case "accepted":
        return now.text || text.draft.changesNothing;
      case "refused":
        return text.draft.cannotSave;
    }
  }
}
