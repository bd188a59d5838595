import { createSignal, For, onCleanup, Show } from "solid-js";
import { useConsole } from "../../console";
import type { Order, UpwindPlaceView, UpwindView, VehicleView } from "../../protocol";
import type { Outcome } from "../../source/stationSource";
import { vehicleLabel } from "../../text/names";
import { formatAge, formatFraction, formatQuantity } from "../../text/quantities";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";

/** The wind turns in minutes, and the imaging drone moves by itself only a little. */
const ASK_EVERY_MS = 10_000;

/** Where each imaging drone would see more of the shade to come, with a button to send it there. */
export function UpwindPlace() {
  const { fleet } = useConsole();
  const imagers = () => fleet.vehicles.filter(({ is_imager: isImager }) => isImager);
  return (
    <section class="section" aria-label="View upwind">
      <For each={imagers()}>{(vehicle) => <Place vehicle={vehicle} />}</For>
    </section>
  );
}

function Place(props: { vehicle: VehicleView }) {
  const { clock, orderApi, source } = useConsole();
  const [answer, setAnswer] = createSignal<Outcome<UpwindView> | null>(null);
  const serial = () => props.vehicle.serial ?? "";
  let cancel = () => {};
  let isClosed = false;
  const ask = async () => {
    const outcome = await source.upwindPlace(serial());
    if (isClosed) return;
    setAnswer(outcome);
    cancel = clock.after(ASK_EVERY_MS, () => void ask());
  };
  void ask();
  onCleanup(() => {
    isClosed = true;
    cancel();
  });
  const place = () => {
    const outcome = answer();
    return outcome?.kind === "answered" ? outcome.value.place : null;
  };
  const problem = () => {
    const outcome = answer();
    if (outcome?.kind === "answered") return outcome.value.reason;
    return outcome?.kind === "failed" ? outcome.problem : null;
  };
  const target = () => {
    const found = place();
    return found === null || found.distance_m === 0 ? null : found;
  };
  const fly = () => {
    const to = target();
    if (to === null) return;
    void orderApi.order({ serials: [serial()], order: gotoOf(to) }, [vehicleLabel(props.vehicle)]);
  };
  const name = () => vehicleLabel(props.vehicle);
  const missing = () => (problem() === null ? "" : `No place upwind for ${name()}: ${problem()}.`);
  return (
    <>
      <p class="muted wire-text" data-testid="upwind-place">
        <Show when={place()} fallback={missing()}>
          {(found) => upwindText(name(), found())}
        </Show>
      </p>
      <Show when={target()}>
        {(to) => (
          <GuardButton
            label="Fly upwind"
            name={`Fly ${name()} ${formatQuantity(to().distance_m, "m", 0)} to its place upwind`}
            hold_ms={GUARD_MS}
            subject={JSON.stringify([to().latitude_deg, to().longitude_deg])}
            onConfirm={fly}
          />
        )}
      </Show>
    </>
  );
}

/** What a place upwind costs, and what is seen from it. */
export function upwindText(name: string, place: UpwindPlaceView): string {
  const { here, there, distance_m, takes_s } = place;
  const sees = ({ now, in_60_s }: UpwindPlaceView["here"]) =>
    `${formatFraction(now)} of the region now and ${formatFraction(in_60_s)} of its shade in 60 s`;
  if (distance_m === 0)
    return `${name} sees ${sees(here)}; no place that is allowed sees much more.`;
  return (
    `${name} sees ${sees(here)}; ${formatQuantity(distance_m, "m", 0)} away, in ` +
    `${formatAge(takes_s)}, it would see ${sees(there)}.`
  );
}

function gotoOf(place: UpwindPlaceView): Order {
  const { latitude_deg, longitude_deg, height_above_takeoff_m, yaw_deg, speed_mps } = place;
  return { kind: "goto", latitude_deg, longitude_deg, height_above_takeoff_m, speed_mps, yaw_deg };
}
