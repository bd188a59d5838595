import { Match, Show, Switch } from "solid-js";
import { useConsole } from "../console";
import { frameCaption, isSuperseded } from "../fleet/displayedFrame";
import { formatLength } from "../text/units";
import type { GroundImageInfo } from "./groundImageLayer";

/** Frames arrive about once a second; after five missed ones the ground may have changed. */
const OLD_AFTER_S = 5;

/** Number, age and alignment of the displayed ground image, which may not be the newest. */
export function GroundImageNote(props: { shown: GroundImageInfo | null }) {
  const { fleet } = useConsole();
  return (
    <Switch fallback={<p class="map-note">No ground image yet</p>}>
      <Match when={props.shown}>{(shown) => <ShownNote shown={shown()} />}</Match>
      <Match when={fleet.groundImage}>
        <p class="map-note">Loading ground image</p>
      </Match>
    </Switch>
  );
}

/** How the frame was aligned: the median distance of its features from their places. */
function alignment({ registration, registration_residual_m: residualM }: GroundImageInfo): string {
  if (registration === "unregistered") return "not aligned";
  if (registration === "lost") return "alignment lost: positions may be off by metres";
  return residualM === null ? "aligned" : `aligned to ${formatLength(residualM, 1)}`;
}

function ShownNote(props: { shown: GroundImageInfo }) {
  const { behindS } = useConsole();
  const isOld = () => {
    const { capture } = props.shown;
    return capture === null || capture.age_s + behindS() > OLD_AFTER_S;
  };
  return (
    <p class="map-note" classList={{ "is-old": isOld() }}>
      <Show when={isOld()}>
        <strong class="map-note-old">old</strong>{" "}
      </Show>
      Ground image: {frameCaption(props.shown, behindS())},{" "}
      <span classList={{ "tone-warning": props.shown.registration === "lost" }}>
        {alignment(props.shown)}
      </span>
      <Show when={isSuperseded(props.shown, behindS())}>
        <span class="tone-warning">; a newer frame exists</span>
      </Show>
    </p>
  );
}
