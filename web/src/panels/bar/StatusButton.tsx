import { createMemo, For, Show } from "solid-js";
import { useStation } from "../../console";
import { type Readiness, readiness } from "../../fleet/readiness";
import { simulation } from "../../fleet/vehicleStatus";
import { text } from "../../text/catalogue";
import { Popover } from "../Popover";
import { SeverityMark } from "../SeverityMark";

/** Readiness of station and fleet in a word with its count; a press shows all reasons. */
export function StatusButton() {
  const { source, fleet, behindS } = useStation();
  const now = createMemo(() => readiness(source.state(), source.connection(), behindS()));
  return (
    <Popover
      class="state"
      buttonClass={`button-quiet status-button tone-${now().severity ?? "good"}`}
      title={text.readiness.why}
      button={
        <>
          <SeverityMark severity={now().severity} size={20} />
          <span class="status-words">
            <span class="status-text" data-testid="status-label">
              {text.readiness.labels[now().label]}
            </span>{" "}
            <span class="status-count" data-testid="status-count">
              {now().count}
            </span>
            <Show when={now().cause}>
              {(cause) => <span class="status-cause"> · {cause()}</span>}
            </Show>
            <Show when={SIMULATION[simulation(fleet.vehicles)]}>
              {(words) => <span class="status-simulation">{words()}</span>}
            </Show>
          </span>
        </>
      }
    >
      {() => <Reasons readiness={now()} />}
    </Popover>
  );
}

/** Shown here on screens without room for it in the bar. */
const SIMULATION = { none: "", all: text.readiness.simulation, mixed: text.readiness.mixed };

function Reasons(props: { readiness: Readiness }) {
  return (
    <section class="card status-reasons" aria-label={text.readiness.reasons}>
      <Show when={props.readiness.reasons.length > 0} fallback={<p>{text.readiness.noProblems}</p>}>
        <ul>
          <For each={props.readiness.reasons}>
            {(reason) => (
              <li class={`tone-${reason.severity}`}>
                <SeverityMark severity={reason.severity} />
                <span class="wire-text">
                  <Show when={reason.vehicleName}>{(name) => <strong>{name()}: </strong>}</Show>
                  {reason.text}
                </span>
              </li>
            )}
          </For>
        </ul>
      </Show>
    </section>
  );
}
