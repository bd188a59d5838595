import { For } from "solid-js";
import type { LightSharesView } from "../../protocol";
import { type LightPercents, lightPercents } from "../../text/light";

const LIGHTS: readonly (readonly [keyof LightPercents, string])[] = [
  ["sun", "Sun"],
  ["shade", "Shade"],
  ["unknown", "Light unknown"],
];

/** Shares of the ground in view as a bar, with the colours and patterns that the map uses. */
export function LightShares(props: { inView: LightSharesView }) {
  const percents = () => lightPercents(props.inView);
  return (
    <>
      <div class="light-bar" aria-hidden="true">
        <For each={LIGHTS}>
          {([light]) => <span class={`is-${light}`} style={{ width: `${percents()[light]}%` }} />}
        </For>
      </div>
      <ul class="light-legend" aria-label="Light on the ground in view">
        <For each={LIGHTS}>
          {([light, label]) => (
            <li>
              <span class={`light-swatch is-${light}`} aria-hidden="true" />
              {label} {percents()[light]}&nbsp;%
            </li>
          )}
        </For>
      </ul>
    </>
  );
}
