import { createMemo, For, Show } from "solid-js";
import { useConsole } from "../../console";
import { type Readiness, readiness } from "../../fleet/readiness";
import { simulation } from "../../fleet/vehicleStatus";
import { Popover } from "../Popover";
import { SeverityMark } from "../SeverityMark";

/** Readiness of station and fleet in a word with its count; a press shows all reasons. */
export function StatusButton() {
  const { source, fleet, behindS } = useConsole();
  const now = createMemo(() => readiness(source.state(), source.connection(), behindS()));
  return (
    <Popover
      class="state"
      buttonClass={`button-quiet status-button tone-${now().severity ?? "good"}`}
      title="Why"
      button={
        <>
          <SeverityMark severity={now().severity} size={20} />
          <span class="status-words">
            <span class="status-text" data-testid="status-label">
              {now().label}
            </span>{" "}
            <span class="status-count" data-testid="status-count">
              {now().count}
            </span>
            <Show when={SIMULATION[simulation(fleet.vehicles)]}>
              {(text) => <span class="status-simulation">{text()}</span>}
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
const SIMULATION = { none: "", all: "Simulation", mixed: "Real and simulated" } as const;

function Reasons(props: { readiness: Readiness }) {
  return (
    <section class="card status-reasons" aria-label="Reasons">
      <Show
        when={props.readiness.reasons.length > 0}
        fallback={<p>All vehicles connected, no problems</p>}
      >
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
