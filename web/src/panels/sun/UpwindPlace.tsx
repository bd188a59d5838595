import { createSignal, For, onCleanup, Show } from "solid-js";
import { useOrders, useStation } from "../../console";
import type {
  MoveUpwindView,
  Order,
  Outcome,
  UpwindPlaceView,
  UpwindView,
  VehicleView,
} from "../../protocol";
import { text } from "../../text/catalogue";
import { vehicleLabel } from "../../text/names";
import { formatLength, withLengthUnit } from "../../text/units";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { MotionProgress } from "./MotionProgress";

/** The wind turns in minutes, and the imaging drone moves automatically only a little. */
const ASK_EVERY_MS = 10_000;

/** Where each imaging drone would see more of the shade to come, with a button to send it there. */
export function UpwindPlace() {
  const { fleet } = useStation();
  const imagers = () => fleet.vehicles.filter(({ is_imager: isImager }) => isImager);
  return (
    <section class="section" aria-label={text.upwind.name}>
      <For each={imagers()}>{(vehicle) => <Place vehicle={vehicle} />}</For>
      <Show when={fleet.moveUpwind}>
        {(view) => <MotionProgress view={view()} stage={stageText(view())} testId="move-upwind" />}
      </Show>
    </section>
  );
}

function Place(props: { vehicle: VehicleView }) {
  const { clock, source } = useStation();
  const { orderApi } = useOrders();
  const [answer, setAnswer] = createSignal<Outcome<UpwindView> | null>(null);
  const serial = () => props.vehicle.serial ?? "";
  let cancel = () => {};
  let isClosed = false;
  const ask = async () => {
    const outcome = await source.light.upwindPlace(serial());
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
  const missing = () => (problem() === null ? "" : text.upwind.noPlace(name(), problem() ?? ""));
  return (
    <>
      <p class="muted wire-text" data-testid="upwind-place">
        <Show when={place()} fallback={missing()}>
          {(found) => `${name()} ${withLengthUnit(found().sentence)}.`}
        </Show>
      </p>
      <Show when={target()}>
        {(to) => (
          <GuardButton
            label={text.upwind.fly}
            of={`${name()}, ${distance(to())}`}
            hold_ms={GUARD_MS}
            subject={JSON.stringify([to().latitude_deg, to().longitude_deg])}
            onConfirm={fly}
          />
        )}
      </Show>
    </>
  );
}

/** A stage as shown after the vehicle's name. */
function stageText({ stage, place }: MoveUpwindView): string {
  return text.upwind.stages[stage]?.(distance(place)) ?? stage;
}

function distance({ distance_m }: UpwindPlaceView): string {
  return formatLength(distance_m);
}

function gotoOf(place: UpwindPlaceView): Order {
  const { latitude_deg, longitude_deg, height_above_takeoff_m, yaw_deg, speed_mps } = place;
  return { kind: "goto", latitude_deg, longitude_deg, height_above_takeoff_m, speed_mps, yaw_deg };
}
