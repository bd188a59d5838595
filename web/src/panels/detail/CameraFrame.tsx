import { createEffect, createSignal, on, onCleanup, Show } from "solid-js";
import { useConsole } from "../../console";
import { createFrameOnScreen, frameCaption, lacksNewer } from "../../fleet/displayedFrame";
import type { VehicleView } from "../../protocol";
import { LatestPicture, type ShownPicture } from "./latestPicture";

/** After a picture that did not come, wait so long before asking again. */
const RETRY_MS = 2_000;

/** The newest picture of one vehicle's camera that came, as it came. The caption is that picture's own. */
export function CameraFrame(props: { serial: string; vehicle: VehicleView }) {
  const { source, clock } = useConsole();
  const [shown, setShown] = createSignal<ShownPicture | null>(null);
  const onScreen = createFrameOnScreen(
    source,
    (state) => state.vehicles.find(({ serial }) => serial === props.serial)?.frame ?? null,
  );
  const picture = new LatestPicture({
    fetch: (key) => source.vehicleFrame(key.serial, key.frameId),
    addresses: {
      create: (blob) => URL.createObjectURL(blob),
      revoke: (url) => URL.revokeObjectURL(url),
    },
    show: (newest) => {
      setShown(newest);
      if (newest === null) onScreen.clear();
      else onScreen.show(newest.frameId);
    },
    later: (action) => clock.after(RETRY_MS, action),
  });
  createEffect(
    on([() => props.serial, () => props.vehicle.frame?.id ?? null, onScreen.run], ([serial, id]) =>
      picture.want(id === null ? null : { serial, frameId: id }),
    ),
  );
  onCleanup(() => picture.close());
  return (
    <figure class="camera">
      <Show when={shown()} fallback={<p class="camera-empty">Picture on its way</p>}>
        {(known) => <img src={known().url} alt={`Camera of ${props.vehicle.name}`} />}
      </Show>
      <Caption of={onScreen.facts()} />
    </figure>
  );
}

function Caption(props: { of: ReturnType<ReturnType<typeof createFrameOnScreen>["facts"]> }) {
  const { behindS } = useConsole();
  return (
    <Show when={props.of}>
      {(frame) => (
        <figcaption class="muted">
          {capitalised(frameCaption(frame(), behindS()))}
          <Show when={lacksNewer(frame(), behindS())}>
            <span class="tone-warning">, newer not loaded</span>
          </Show>
        </figcaption>
      )}
    </Show>
  );
}

function capitalised(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}
