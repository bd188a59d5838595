import { createSignal, For, Show } from "solid-js";
import { useOrders, useStation } from "../../console";
import type { OrderApi } from "../../orders/orderApi";
import { text } from "../../text/catalogue";
import { Answer } from "../orders/AnswerNotice";

type CameraOrder =
  | { kind: "camera_start"; fps_hz: number }
  | { kind: "camera_stop" }
  | { kind: "camera_lock"; is_locked: boolean };

/** Selectable frame rates. */
const RATES_HZ = [1, 2, 5] as const;

/**
 * Starts and stops one vehicle's camera. A routine order: one press, kept away from the orders that move a
 * vehicle. Answers go to `orderApi`, which outlives this component.
 */
export function CameraControl(props: { orderApi: OrderApi }) {
  const { fleet, lacks } = useStation();
  const { targets, selection } = useOrders();
  const [fps_hz, setFps_hz] = createSignal<number>(RATES_HZ[0]);
  const isOne = () => selection.keys().length === 1 && targets().serials.length === 1;
  /** The facts of the vehicle's app, if it takes orders to lock exposure. */
  const lockable = () => {
    const serial = isOne() ? targets().serials[0] : null;
    const facts = fleet.vehicles.find((vehicle) => vehicle.serial === serial)?.app_facts;
    return facts?.orders?.includes("lock_camera") ? facts : null;
  };
  const order = (order: CameraOrder) => {
    if (!isOne()) return;
    const { serials, labels } = targets();
    void props.orderApi.order({ serials, order }, labels);
  };
  return (
    <section class="camera-control" aria-label={text.camera.name}>
      <fieldset class="camera-rates" aria-label={text.camera.rates}>
        <For each={RATES_HZ}>
          {(rate) => (
            <button
              type="button"
              class="button"
              disabled={!isOne()}
              aria-pressed={fps_hz() === rate}
              aria-label={text.camera.rate(rate)}
              onClick={() => setFps_hz(rate)}
            >
              {rate}
            </button>
          )}
        </For>
        <span class="muted">{text.camera.perSecond}</span>
      </fieldset>
      <div class="camera-buttons">
        <button
          type="button"
          class="button"
          disabled={!isOne() || lacks("operator") !== null}
          title={lacks("operator") ?? undefined}
          onClick={() => order({ kind: "camera_start", fps_hz: fps_hz() })}
        >
          {text.camera.start}
        </button>
        <button
          type="button"
          class="button"
          disabled={!isOne() || lacks("operator") !== null}
          title={lacks("operator") ?? undefined}
          onClick={() => order({ kind: "camera_stop" })}
        >
          {text.camera.stop}
        </button>
      </div>
      <Show when={lockable()}>
        {(facts) => (
          <div class="camera-buttons">
            <button
              type="button"
              class="button"
              disabled={lacks("operator") !== null}
              title={lacks("operator") ?? undefined}
              onClick={() =>
                order({ kind: "camera_lock", is_locked: facts().exposure_locked !== true })
              }
            >
              {facts().exposure_locked === true ? text.camera.unlock : text.camera.lock}
            </button>
          </div>
        )}
      </Show>
      <Show when={!isOne()}>
        <p class="muted">{disabledReason(selection.keys().length)}</p>
      </Show>
      <CameraAnswer orderApi={props.orderApi} />
    </section>
  );
}

function disabledReason(selected: number): string {
  if (selected === 0) return text.camera.selectFirst;
  if (selected > 1) return text.camera.selectOne;
  return text.camera.noSerial;
}

/** The station's answer and the command's current phase. */
function CameraAnswer(props: { orderApi: OrderApi }) {
  const { fleet } = useStation();
  const phase = () => {
    const outcome = props.orderApi.lastAnswer()?.outcome;
    const id = outcome?.kind === "answered" ? outcome.value[0]?.command_id : null;
    return fleet.commands.find((command) => command.id === id)?.phase ?? null;
  };
  return (
    <Show when={props.orderApi.lastAnswer()}>
      {(answer) => (
        <div class="camera-answer wire-text" role="status">
          <Answer answer={answer()} />
          <Show when={phase()}>
            {(current) => <p class="muted">{text.commands.phases[current()]}</p>}
          </Show>
        </div>
      )}
    </Show>
  );
}
