import { For, Show } from "solid-js";
import { useOrders, useStation } from "../../console";
import { badgeText, vehicleKey } from "../../fleet/vehicleStatus";
import { createOrderApi } from "../../orders/orderApi";
import type { VehicleView } from "../../protocol";
import { text } from "../../text/catalogue";
import { vehicleLabel } from "../../text/names";
import { agedBy, formatAge } from "../../text/quantities";
import { colourOf, lookClasses } from "../../theme/theme";
import { AuthoritySection } from "../authority/AuthoritySection";
import { HazardSection } from "../hazard/HazardSection";
import { LinkBars } from "../links/LinkBars";
import { Panel } from "../Panel";
import { PreflightSection } from "../preflight/PreflightSection";
import { StopSection } from "../stop/StopLatch";
import { appFactsOf } from "./appFacts";
import { CameraControl } from "./CameraControl";
import { CameraFrame } from "./CameraFrame";
import { type Fact, factsOf } from "./facts";
import "./detail.css";

/** Telemetry of the vehicle selected last, each value with its age. */
export function VehicleDetail() {
  const { fleet, source, clock } = useStation();
  const { selection } = useOrders();
  const cameraOrders = createOrderApi(source.orders, clock);
  const shown = () => {
    const key = selection.keys().at(-1);
    return fleet.vehicles.find((vehicle) => vehicleKey(vehicle) === key);
  };
  return (
    <Show
      when={shown()}
      keyed={false}
      fallback={
        <Panel title={text.panels.titles.vehicle} name="vehicle">
          <p class="panel-empty">{text.detail.none}</p>
          <CameraControl orderApi={cameraOrders} />
        </Panel>
      }
    >
      {(vehicle) => (
        <Panel
          title={vehicle().name}
          name="vehicle"
          actions={
            <>
              <LinkBars linkId={vehicle().link_id} />
              <span
                class={`badge own-colour ${lookClasses(vehicleKey(vehicle()))}`}
                style={{ "--own": colourOf(vehicleKey(vehicle())) }}
              >
                {badgeText(vehicle())}
              </span>
            </>
          }
        >
          <Identity vehicle={vehicle()} />
          <Show when={vehicle().hazard}>
            {(hazard) => <HazardSection hazard={hazard()} name={vehicleLabel(vehicle())} />}
          </Show>
          <Show when={vehicle().serial} keyed>
            {(serial) => <ControlSections serial={serial} vehicle={vehicle()} />}
          </Show>
          <Show when={vehicle().frame === null ? null : vehicle().serial} keyed>
            {(serial) => <CameraFrame serial={serial} vehicle={vehicle()} />}
          </Show>
          <CameraControl orderApi={cameraOrders} />
          <dl class="facts">
            <For each={factsOf(vehicle())}>{(fact) => <FactRow fact={fact} />}</For>
          </dl>
          <Show when={appFactsOf(vehicle()).length > 0}>
            <h3 class="facts-head">{text.detail.reported}</h3>
            <dl class="facts facts-reported">
              <For each={appFactsOf(vehicle())}>{(fact) => <FactRow fact={fact} />}</For>
            </dl>
          </Show>
        </Panel>
      )}
    </Show>
  );
}

/** Authority and checklist; recreated per vehicle, so that no answer of another vehicle remains. */
function ControlSections(props: { serial: string; vehicle: VehicleView }) {
  const label = () => vehicleLabel(props.vehicle);
  return (
    <>
      <Show when={props.vehicle.is_stopped}>
        <StopSection serial={props.serial} name={label()} />
      </Show>
      <AuthoritySection
        serial={props.serial}
        name={label()}
        authority={props.vehicle.authority}
        lease={props.vehicle.lease}
      />
      <PreflightSection serial={props.serial} name={label()} />
    </>
  );
}

function Identity(props: { vehicle: VehicleView }) {
  const conflicts = () => props.vehicle.conflict_link_ids;
  // A simulated vehicle without a model is called "simulated", which stands at the end anyway.
  const isSimulatedModel = () => props.vehicle.is_simulated && props.vehicle.model === "simulated";
  return (
    <div class="detail-identity">
      <p class="wire-text">
        <Show when={!isSimulatedModel()}>
          {props.vehicle.model}
          {" · "}
        </Show>
        {props.vehicle.serial === null
          ? text.detail.noSerial
          : text.detail.serial(props.vehicle.serial)}
        <Show when={props.vehicle.is_simulated}> · {text.detail.simulated}</Show>
      </p>
      <Show when={conflicts().length > 0}>
        <p class="tone-error">{text.detail.conflict(conflicts().join(", "))}</p>
      </Show>
    </div>
  );
}

function FactRow(props: { fact: Fact }) {
  const { behindS } = useStation();
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
          <span class="hidden-but-read">{text.detail.age} </span>
          {formatAge(agedBy(props.fact.ageS, behindS()))}
        </Show>
      </dd>
    </div>
  );
}
