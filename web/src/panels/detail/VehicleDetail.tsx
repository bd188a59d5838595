import { For, Show } from "solid-js";
import { useConsole } from "../../console";
import { badgeText, vehicleKey } from "../../fleet/vehicleStatus";
import { createDesk } from "../../orders/orderApi";
import type { VehicleView } from "../../protocol";
import { vehicleLabel } from "../../text/names";
import { agedBy, formatAge } from "../../text/quantities";
import { colourOf } from "../../theme/theme";
import { AuthoritySection } from "../authority/AuthoritySection";
import { HazardSection } from "../hazard/HazardSection";
import { Panel } from "../Panel";
import { PreflightSection } from "../preflight/PreflightSection";
import { CameraControl } from "./CameraControl";
import { CameraFrame } from "./CameraFrame";
import { type Fact, factsOf } from "./facts";
import "./detail.css";

/** Everything known of the vehicle that was selected last, each value with its age. */
export function VehicleDetail() {
  const { fleet, selection, source, clock } = useConsole();
  const cameraDesk = createDesk(source, clock);
  const shown = () => {
    const key = selection.keys().at(-1);
    return fleet.vehicles.find((vehicle) => vehicleKey(vehicle) === key);
  };
  return (
    <Show
      when={shown()}
      keyed={false}
      fallback={
        <Panel title="Vehicle">
          <p class="panel-empty">Select a vehicle to see everything it says.</p>
          <CameraControl desk={cameraDesk} />
        </Panel>
      }
    >
      {(vehicle) => (
        <Panel
          title={vehicle().name}
          actions={
            <span class="badge own-colour" style={{ "--own": colourOf(vehicleKey(vehicle())) }}>
              {badgeText(vehicle())}
            </span>
          }
        >
          <Identity vehicle={vehicle()} />
          <Show when={vehicle().hazard}>
            {(hazard) => <HazardSection hazard={hazard()} name={vehicleLabel(vehicle())} />}
          </Show>
          <Show when={vehicle().serial} keyed>
            {(serial) => <Words serial={serial} vehicle={vehicle()} />}
          </Show>
          <Show when={vehicle().frame === null ? null : vehicle().serial} keyed>
            {(serial) => <CameraFrame serial={serial} vehicle={vehicle()} />}
          </Show>
          <CameraControl desk={cameraDesk} />
          <dl class="facts">
            <For each={factsOf(vehicle())}>{(fact) => <FactRow fact={fact} />}</For>
          </dl>
        </Panel>
      )}
    </Show>
  );
}

/** Who leads it and whether it is ready: made anew for another vehicle, so that no answer stays. */
function Words(props: { serial: string; vehicle: VehicleView }) {
  const label = () => vehicleLabel(props.vehicle);
  return (
    <>
      <AuthoritySection serial={props.serial} name={label()} authority={props.vehicle.authority} />
      <PreflightSection serial={props.serial} name={label()} />
    </>
  );
}

function Identity(props: { vehicle: VehicleView }) {
  const conflicts = () => props.vehicle.conflict_link_ids;
  return (
    <div class="detail-identity">
      <p class="wire-text">
        {props.vehicle.model}
        {" · "}
        {props.vehicle.serial === null
          ? "serial not received yet: only ALL STOP reaches it"
          : `serial ${props.vehicle.serial}`}
        <Show when={props.vehicle.is_simulated}> · simulated</Show>
      </p>
      <Show when={conflicts().length > 0}>
        <p class="tone-error">
          In conflict: link {conflicts().join(", ")} claims the same serial. Hover, land and return
          go to every link that does.
        </p>
      </Show>
    </div>
  );
}

function FactRow(props: { fact: Fact }) {
  const { behindS } = useConsole();
  const isUnknown = () => props.fact.why !== null;
  return (
    <div class="fact">
      <dt>{props.fact.name}</dt>
      <dd class="fact-value wire-text" classList={{ muted: isUnknown() }}>
        {props.fact.text}
        <Show when={props.fact.why}>{(why) => <span> {why()}</span>}</Show>
      </dd>
      <dd class="fact-age">
        <Show when={props.fact.ageS !== null}>
          <span class="hidden-but-read">age </span>
          {formatAge(agedBy(props.fact.ageS, behindS()))}
        </Show>
      </dd>
    </div>
  );
}
