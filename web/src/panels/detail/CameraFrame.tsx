import { createEffect, createSignal, onCleanup, Show } from "solid-js";
import { useConsole } from "../../console";
import type { VehicleView } from "../../protocol";
import { formatAge } from "../../words/age";
import { LatestPicture } from "./latestPicture";

/** The newest picture of a vehicle's camera, as it came. */
export function CameraFrame(props: { vehicle: VehicleView }) {
  const { source, behindS } = useConsole();
  const [address, setAddress] = createSignal<string | null>(null);
  const picture = new LatestPicture(
    (key) => source.vehicleFrame(key.serial, key.frameId),
    { create: (blob) => URL.createObjectURL(blob), revoke: (url) => URL.revokeObjectURL(url) },
    setAddress,
  );
  createEffect(() => {
    const { serial, frame } = props.vehicle;
    if (serial !== null && frame !== null) picture.want({ serial, frameId: frame.id });
  });
  onCleanup(() => picture.close());
  return (
    <figure class="camera">
      <Show when={address()} fallback={<p class="camera-empty">Picture on its way</p>}>
        {(url) => <img src={url()} alt={`Camera of ${props.vehicle.name}`} />}
      </Show>
      <Show when={props.vehicle.frame}>
        {(frame) => (
          <figcaption class="muted">
            Frame {frame().id}, taken {formatAge(frame().captured_age_s + behindS())} ago ±{" "}
            {frame().captured_sigma_s.toFixed(1)} s
          </figcaption>
        )}
      </Show>
    </figure>
  );
}
