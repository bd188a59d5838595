import { createEffect, createSignal, on, onCleanup, Show } from "solid-js";
import { useStation } from "../../console";
import { createDisplayedFrame, frameCaption, isSuperseded } from "../../fleet/displayedFrame";
import type { VehicleView } from "../../protocol";
import { text } from "../../text/catalogue";
import { capitalised } from "../../text/names";
import { LatestPicture, type ShownPicture } from "./latestPicture";

/** Wait this long before requesting a failed picture again. */
const RETRY_MS = 2_000;

/** The newest camera picture of one vehicle that has loaded, with its own caption. */
export function CameraFrame(props: { serial: string; vehicle: VehicleView }) {
  const { source, clock } = useStation();
  const [shown, setShown] = createSignal<ShownPicture | null>(null);
  const displayed = createDisplayedFrame(
    source,
    (state) => state.vehicles.find(({ serial }) => serial === props.serial)?.frame ?? null,
  );
  const latest = new LatestPicture({
    fetch: (key) => source.vehicles.frame(key.serial, key.frameId),
    addresses: {
      create: (blob) => URL.createObjectURL(blob),
      revoke: (url) => URL.revokeObjectURL(url),
    },
    show: (newest) => {
      setShown(newest);
      if (newest === null) displayed.clear();
      else displayed.show(newest.frameId);
    },
    later: (action) => clock.after(RETRY_MS, action),
  });
  createEffect(
    on([() => props.serial, () => props.vehicle.frame?.id ?? null, displayed.run], ([serial, id]) =>
      latest.request(id === null ? null : { serial, frameId: id }),
    ),
  );
  onCleanup(() => latest.close());
  return (
    <figure class="camera">
      <Show when={shown()} fallback={<p class="camera-empty">{text.camera.loading}</p>}>
        {(picture) => <img src={picture().url} alt={text.camera.of(props.vehicle.name)} />}
      </Show>
      <Caption of={displayed.info()} />
    </figure>
  );
}

function Caption(props: { of: ReturnType<ReturnType<typeof createDisplayedFrame>["info"]> }) {
  const { behindS } = useStation();
  return (
    <Show when={props.of}>
      {(frame) => (
        <figcaption class="muted">
          {capitalised(frameCaption(frame(), behindS()))}
          <Show when={isSuperseded(frame(), behindS())}>
            <span class="tone-warning">{text.frames.newerExists}</span>
          </Show>
        </figcaption>
      )}
    </Show>
  );
}
