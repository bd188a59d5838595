import { Match, Show, Switch } from "solid-js";
import { useStation } from "../console";
import { frameCaption, isSuperseded } from "../fleet/displayedFrame";
import { text } from "../text/catalogue";
import { formatLength } from "../text/units";
import type { GroundImageInfo } from "./groundImageLayer";

/** Frames arrive about once a second; after five missed ones the ground may have changed. */
const OLD_AFTER_S = 5;

/** Number, age and alignment of the displayed ground image, which may not be the newest. */
export function GroundImageNote(props: { shown: GroundImageInfo | null }) {
  const { fleet } = useStation();
  return (
    <Switch fallback={<p class="map-note">{text.groundImage.none}</p>}>
      <Match when={props.shown}>{(shown) => <ShownNote shown={shown()} />}</Match>
      <Match when={fleet.groundImage}>
        <p class="map-note">{text.groundImage.loading}</p>
      </Match>
    </Switch>
  );
}

/** How the frame was aligned: the median distance of its features from their places. */
function alignment({ registration, registration_residual_m: residualM }: GroundImageInfo): string {
  if (registration === "unregistered") return text.groundImage.notAligned;
  if (registration === "lost") return text.groundImage.lost;
  if (residualM === null) return text.groundImage.aligned;
  return text.groundImage.alignedTo(formatLength(residualM, 1));
}

function ShownNote(props: { shown: GroundImageInfo }) {
  const { behindS } = useStation();
  const isOld = () => {
    const { capture } = props.shown;
    return capture === null || capture.age_s + behindS() > OLD_AFTER_S;
  };
  return (
    <p class="map-note" classList={{ "is-old": isOld() }}>
      <Show when={isOld()}>
        <strong class="map-note-old">{text.groundImage.old}</strong>{" "}
      </Show>
      {text.groundImage.image(frameCaption(props.shown, behindS()))},{" "}
      <span classList={{ "tone-warning": props.shown.registration === "lost" }}>
        {alignment(props.shown)}
      </span>
      <Show when={isSuperseded(props.shown, behindS())}>
        <span class="tone-warning">{text.frames.newerExists}</span>
      </Show>
    </p>
  );
}
