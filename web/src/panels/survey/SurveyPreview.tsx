import { createResource, For, Show } from "solid-js";
import { useOrders, useStation } from "../../console";
import { targetsKey } from "../../orders/targets";
import type { SurveyEstimateView, SurveyView } from "../../protocol";
import { text } from "../../text/catalogue";
import { UNKNOWN } from "../../text/quantities";
import { estimateFacts } from "../../text/survey";
import { PlanExports } from "./PlanExports";

/** What a planned survey will take with the selected drones, before its start. */
export function SurveyPreview(props: { survey: SurveyView }) {
  const { source } = useStation();
  const { targets } = useOrders();
  const asked = () => ({
    id: props.survey.id,
    serials: targets().serials,
    key: `${props.survey.id} ${targetsKey(targets())}`,
  });
  // By key: the selection is a new object with every state, ten times a second.
  const [outcome] = createResource(
    () => asked().key,
    () => source.surveys.estimate(asked().id, asked().serials),
  );
  const estimate = (): SurveyEstimateView | null => {
    const latest = outcome.latest;
    return latest?.kind === "answered" ? latest.value : null;
  };
  const failed = () => (outcome.latest?.kind === "failed" ? outcome.latest.problem : null);
  const assumed = () =>
    targets().serials.length === 0 ? text.estimate.withOne : text.estimate.withSelected;
  return (
    <div class="survey-preview" data-testid={`estimate-${props.survey.id}`}>
      <Show
        when={estimate()}
        fallback={<p class="muted">{failed() ?? text.estimate.unknown(UNKNOWN)}</p>}
      >
        {(found) => (
          <>
            <p class="muted">{assumed()}</p>
            <dl class="survey-facts">
              <For each={estimateFacts(found())}>
                {([name, value]) => (
                  <>
                    <dt>{name}</dt>
                    <dd>{value}</dd>
                  </>
                )}
              </For>
            </dl>
            <For each={[found().refusal, ...found().warnings].filter((one) => one !== null)}>
              {(warning) => <p class="survey-warning wire-text">{warning}</p>}
            </For>
          </>
        )}
      </Show>
      <PlanExports survey={props.survey} />
    </div>
  );
}
