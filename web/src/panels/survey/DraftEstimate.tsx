import { createEffect, createMemo, createSignal, For, on, onCleanup, Show } from "solid-js";
import { useOrders, useStation } from "../../console";
import { targetsKey } from "../../orders/targets";
import type { NewSurvey, Outcome, SurveyEstimateView } from "../../protocol";
import { draftFacts } from "../../text/survey";
import { withLengthUnit } from "../../text/units";

/** A form is asked about when nothing was typed for so long. */
const PAUSE_MS = 400;

/** What the survey of the form would take with the selected drones; null: nothing to ask. */
export function DraftEstimate(props: { survey: NewSurvey | null }) {
  const { source, clock } = useStation();
  const { targets } = useOrders();
  const [outcome, setOutcome] = createSignal<Outcome<SurveyEstimateView> | null>(null);
  const key = createMemo(() => `${JSON.stringify(props.survey)} ${targetsKey(targets())}`);
  createEffect(
    on(key, () => {
      const { survey } = props;
      if (survey === null) return;
      let isOld = false;
      const cancel = clock.after(PAUSE_MS, async () => {
        const found = await source.surveys.estimateDraft(survey, targets().serials);
        if (!isOld) setOutcome(found);
      });
      onCleanup(() => {
        isOld = true;
        cancel();
      });
    }),
  );
  const problems = () => {
    const found = outcome();
    if (found === null || props.survey === null) return [];
    if (found.kind === "failed") return [found.problem];
    return [found.value.refusal, ...found.value.warnings].filter((one) => one !== null);
  };
  const facts = () => {
    const found = outcome();
    return found?.kind === "answered" && found.value.refusal === null
      ? draftFacts(found.value, targets().serials.length)
      : null;
  };
  /** Whose rows these are. */
  const note = () => {
    const found = outcome();
    return found?.kind === "answered" && props.survey !== null ? found.value.rows_note : "";
  };
  return (
    <div class="survey-wide" role="status">
      <Show when={facts()}>{(line) => <p>{line()}</p>}</Show>
      <Show when={note()}>{(line) => <p class="muted wire-text">{withLengthUnit(line())}</p>}</Show>
      <For each={problems()}>
        {(problem) => <p class="survey-warning wire-text">{withLengthUnit(problem)}</p>}
      </For>
    </div>
  );
}
