import { createSignal, For } from "solid-js";
import { useMapModes } from "../../console";
import type { NudgeBy } from "../../orders/flyHere";
import { text } from "../../text/catalogue";
import { type LengthUnit, lengthUnit, metresOf } from "../../text/units";
import { BRIEF_MS, GuardButton } from "../guard/GuardButton";

/** Round numbers of each unit. */
const STEPS: Readonly<Record<LengthUnit, readonly number[]>> = { m: [1, 2, 5], ft: [3, 6, 15] };
const TURN_DEG = 15;

interface Nudge {
  readonly icon: string;
  readonly name: keyof typeof text.fly.nudges;
  by(step_m: number): NudgeBy;
}

/** In display order: north on top, opposites around the centre. */
const NUDGES: readonly Nudge[] = [
  { icon: "↺", name: "left", by: () => ({ turn_deg: -TURN_DEG }) },
  { icon: text.fly.north, name: "north", by: (north_m) => ({ north_m }) },
  { icon: "↻", name: "right", by: () => ({ turn_deg: TURN_DEG }) },
  { icon: "↥", name: "up", by: (up_m) => ({ up_m }) },
  { icon: text.fly.west, name: "west", by: (step_m) => ({ east_m: -step_m }) },
  { icon: text.fly.south, name: "south", by: (step_m) => ({ north_m: -step_m }) },
  { icon: text.fly.east, name: "east", by: (east_m) => ({ east_m }) },
  { icon: "↧", name: "down", by: (step_m) => ({ up_m: -step_m }) },
];

/** Small steps from the current position; each button must be held briefly. */
export function NudgePad(props: { name: string }) {
  const { flyHere } = useMapModes();
  const [size, setSize] = createSignal(0);
  const steps = () => STEPS[lengthUnit()];
  const step_m = () => metresOf(steps()[size()] ?? 1);
  const subject = () => JSON.stringify([flyHere.vehicle()?.serial, step_m()]);
  return (
    <details class="nudges">
      <summary>{text.fly.nudge}</summary>
      <fieldset class="nudge-steps" aria-label={text.fly.stepSize}>
        <For each={steps()}>
          {(step, index) => (
            <button
              type="button"
              class="button"
              aria-pressed={size() === index()}
              onClick={() => setSize(index())}
            >
              {step} {lengthUnit()}
            </button>
          )}
        </For>
      </fieldset>
      <div class="nudge-pad">
        <For each={NUDGES}>
          {(nudge) => (
            <GuardButton
              label={nudge.icon}
              of={text.fly.nudges[nudge.name](props.name, `${TURN_DEG}°`)}
              class="guard-small"
              hold_ms={BRIEF_MS}
              subject={subject()}
              onConfirm={() => flyHere.nudge(nudge.by(step_m()))}
            />
          )}
        </For>
      </div>
      <p class="muted">{text.fly.nudgeHow}</p>
    </details>
  );
}
