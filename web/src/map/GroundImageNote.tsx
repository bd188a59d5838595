import { Show } from "solid-js";
import { useConsole } from "../console";
import { formatAge } from "../words/age";

/** A frame is taken about once a second; five missed in a row and the ground may look otherwise by now. */
const OLD_AFTER_S = 5;

/** Which frame lies on the ground, how old it is and how well it is placed. */
export function GroundImageNote() {
  const { fleet, behindS } = useConsole();
  return (
    <Show when={fleet.groundImage} fallback={<p class="map-note">No ground image yet</p>}>
      {(shown) => {
        const ageS = () => shown().captured_age_s + behindS();
        const isOld = () => ageS() > OLD_AFTER_S;
        return (
          <p class="map-note" classList={{ "is-old": isOld() }}>
            <Show when={isOld()}>
              <strong class="map-note-old">old</strong>{" "}
            </Show>
            Ground image: frame {shown().frame_id}, taken {formatAge(ageS())} ago ±{" "}
            {shown().captured_sigma_s.toFixed(1)} s, {shown().registration}
          </p>
        );
      }}
    </Show>
  );
}
