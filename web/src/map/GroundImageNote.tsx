import { Match, Show, Switch } from "solid-js";
import { useConsole } from "../console";
import { frameCaption, lacksNewer } from "../fleet/displayedFrame";
import type { ShownGround } from "./groundImageLayer";

/** A frame is taken about once a second; five missed in a row and the ground may look otherwise by now. */
const OLD_AFTER_S = 5;

/** Which frame lies on the ground, how old it is and how well it is placed: the one shown, not the newest. */
export function GroundImageNote(props: { shown: ShownGround | null }) {
  const { fleet } = useConsole();
  return (
    <Switch fallback={<p class="map-note">No ground image yet</p>}>
      <Match when={props.shown}>{(shown) => <ShownNote shown={shown()} />}</Match>
      <Match when={fleet.groundImage}>
        <p class="map-note">Ground image on its way</p>
      </Match>
    </Switch>
  );
}

function ShownNote(props: { shown: ShownGround }) {
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
      Ground image: {frameCaption(props.shown, behindS())}, {props.shown.registration}
      <Show when={lacksNewer(props.shown, behindS())}>
        <span class="tone-warning">, newer not loaded</span>
      </Show>
    </p>
  );
}
