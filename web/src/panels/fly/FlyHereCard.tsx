import { Show } from "solid-js";
import { useMapModes } from "../../console";
import { courseText } from "../../orders/course";
import { text } from "../../text/catalogue";
import { vehicleLabel } from "../../text/names";
import { lengthUnit } from "../../text/units";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { CheckResult } from "./CheckResult";
import { NudgePad } from "./NudgePad";
import "./fly.css";

/** Fly here: target, height, speed, the safety gate's result, and the button to confirm. */
export function FlyHereCard() {
  const { flyHere } = useMapModes();
  const name = () => {
    const vehicle = flyHere.vehicle();
    return vehicle === null ? "" : vehicleLabel(vehicle);
  };
  const onKeyDown = (event: KeyboardEvent) => {
    if (event.key !== "Escape") return;
    event.stopPropagation();
    flyHere.clear();
  };
  return (
    <Show when={flyHere.isOn()}>
      <section class="card fly" aria-label={text.fly.name(name())} onKeyDown={onKeyDown}>
        <header class="fly-head">
          <h2 class="wire-text">{text.fly.title(name())}</h2>
          <button
            type="button"
            class="button"
            aria-label={text.fly.leave}
            onClick={() => flyHere.toggle()}
          >
            ✕
          </button>
        </header>
        <Show when={flyHere.target()} fallback={<Aim />}>
          <p class="fly-course">
            <Show when={flyHere.course()} fallback={text.fly.noDistance}>
              {(course) => <strong>{courseText(course())}</strong>}
            </Show>
          </p>
        </Show>
        <div class="fly-fields">
          <label>
            {text.fly.height(lengthUnit())}
            <input
              class="field"
              type="text"
              inputmode="decimal"
              value={flyHere.height.text()}
              onInput={(event) => flyHere.height.type(event.currentTarget.value)}
            />
          </label>
          <label>
            {text.fly.speed}
            <input
              class="field"
              type="text"
              inputmode="decimal"
              value={flyHere.speed()}
              onInput={(event) => flyHere.setSpeed(event.currentTarget.value)}
            />
          </label>
        </div>
        <CheckResult
          check={flyHere.check()}
          lack={flyHere.target() === null ? null : text.fly.notNumbers}
        />
        <GuardButton
          label={text.fly.go}
          of={name()}
          class="fly-go"
          hold_ms={GUARD_MS}
          subject={flyHere.subject()}
          onConfirm={() => flyHere.confirm()}
        />
        <NudgePad name={name()} />
      </section>
    </Show>
  );
}

function Aim() {
  const { aimAtCentre } = useMapModes();
  return (
    <div class="fly-aim">
      <p>{text.fly.aim}</p>
      <button type="button" class="button" onClick={() => aimAtCentre()}>
        {text.fly.useCentre}
      </button>
    </div>
  );
}
