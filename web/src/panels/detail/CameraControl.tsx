import { createSignal, For, Show } from "solid-js";
import { useConsole } from "../../console";
import type { Desk } from "../../orders/orderApi";
import { PHASE_NAMES } from "../../text/names";
import { AnswerBody } from "../orders/OrderAnswer";

/** Pictures per second that can be asked for. */
const RATES_HZ = [1, 2, 5] as const;

/**
 * Starts and stops one vehicle's pictures. A routine order: one press, and kept away from the orders that
 * move a vehicle. The answers go to `desk`, which outlives this part of the page.
 */
export function CameraControl(props: { desk: Desk }) {
  const { targets, selection } = useConsole();
  const [fps_hz, setFps_hz] = createSignal<number>(RATES_HZ[0]);
  const isOne = () => selection.keys().length === 1 && targets().serials.length === 1;
  const order = (order: { kind: "camera_start"; fps_hz: number } | { kind: "camera_stop" }) => {
    if (!isOne()) return;
    const { serials, labels } = targets();
    void props.desk.order({ serials, order }, labels);
  };
  return (
    <section class="camera-control" aria-label="Camera">
      <fieldset class="camera-rates" aria-label="Pictures per second">
        <For each={RATES_HZ}>
          {(rate) => (
            <button
              type="button"
              class="button"
              disabled={!isOne()}
              aria-pressed={fps_hz() === rate}
              aria-label={`${rate} per second`}
              onClick={() => setFps_hz(rate)}
            >
              {rate}
            </button>
          )}
        </For>
        <span class="muted">pictures per second</span>
      </fieldset>
      <div class="camera-buttons">
        <button
          type="button"
          class="button"
          disabled={!isOne()}
          onClick={() => order({ kind: "camera_start", fps_hz: fps_hz() })}
        >
          Start camera
        </button>
        <button
          type="button"
          class="button"
          disabled={!isOne()}
          onClick={() => order({ kind: "camera_stop" })}
        >
          Stop camera
        </button>
      </div>
      <Show when={!isOne()}>
        <p class="muted">{whyNot(selection.keys().length)}</p>
      </Show>
      <CameraAnswer desk={props.desk} />
    </section>
  );
}

function whyNot(selected: number): string {
  if (selected === 0) return "Camera: select a vehicle first.";
  if (selected > 1) return "Camera: select one vehicle alone.";
  return "Camera: its app has not said which aircraft it is.";
}

/** What the station said, and how far the command has come since. */
function CameraAnswer(props: { desk: Desk }) {
  const { fleet } = useConsole();
  const phase = () => {
    const outcome = props.desk.last()?.outcome;
    const id = outcome?.kind === "answered" ? outcome.value[0]?.command_id : null;
    return fleet.commands.find((command) => command.id === id)?.phase ?? null;
  };
  return (
    <Show when={props.desk.last()}>
      {(answer) => (
        <div class="camera-answer wire-text" role="status">
          <strong>
            {answer().what} {answer().labels.join()}
          </strong>
          <Show when={answer().outcome.kind === "waiting"}>: asking the station</Show>
          <Show when={phase()}>{(known) => <>: {PHASE_NAMES[known()].toLowerCase()}</>}</Show>
          <AnswerBody answer={answer()} />
        </div>
      )}
    </Show>
  );
}
