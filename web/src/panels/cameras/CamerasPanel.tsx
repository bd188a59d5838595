import { For, type JSX, Show } from "solid-js";
import { usePage, useStation } from "../../console";
import type { VehicleView } from "../../protocol";
import { text } from "../../text/catalogue";
import { vehicleLabel } from "../../text/names";
import { CameraFrame } from "../detail/CameraFrame";
import { Empty, Panel } from "../Panel";
import "./cameras.css";

/** All cameras that send pictures, live; one of them can be large. */
export function CamerasPanel() {
  const { fleet } = useStation();
  const { largeCamera } = usePage();
  const sending = () => fleet.vehicles.filter(isSending);
  return (
    <Panel title={text.panels.titles.cameras} name="cameras" count={sending().length}>
      <Show when={sending().length > 0} fallback={<Empty>{text.cameras.none}</Empty>}>
        <ul class="cameras">
          <For each={sending()}>
            {(vehicle) => (
              <li>
                <Head vehicle={vehicle}>
                  <button
                    type="button"
                    class="button button-quiet"
                    aria-pressed={largeCamera.serial() === vehicle.serial}
                    aria-label={text.cameras.enlarge(vehicleLabel(vehicle))}
                    onClick={() => largeCamera.toggle(vehicle.serial)}
                  >
                    ⤢
                  </button>
                </Head>
                <Show when={largeCamera.serial() !== vehicle.serial}>
                  <CameraFrame serial={vehicle.serial ?? ""} vehicle={vehicle} />
                </Show>
              </li>
            )}
          </For>
        </ul>
      </Show>
    </Panel>
  );
}

/** The large picture, over the free middle of the map; nothing without one. */
export function LargeCamera() {
  const { fleet } = useStation();
  const { largeCamera } = usePage();
  const shown = () =>
    fleet.vehicles.find((vehicle) => isSending(vehicle) && vehicle.serial === largeCamera.serial());
  return (
    <Show when={shown()}>
      {(vehicle) => (
        <section class="card camera-large" aria-label={text.camera.of(vehicleLabel(vehicle()))}>
          <Head vehicle={vehicle()}>
            <button
              type="button"
              class="button button-quiet"
              aria-label={text.cameras.close}
              onClick={() => largeCamera.toggle(null)}
            >
              ✕
            </button>
          </Head>
          <Show when={vehicle().serial} keyed>
            {(serial) => <CameraFrame serial={serial} vehicle={vehicle()} />}
          </Show>
        </section>
      )}
    </Show>
  );
}

function Head(props: { vehicle: VehicleView; children: JSX.Element }) {
  return (
    <div class="camera-head">
      <span class="wire-text">{vehicleLabel(props.vehicle)}</span>
      {props.children}
    </div>
  );
}

const isSending = ({ frame, serial }: VehicleView) => frame !== null && serial !== null;
