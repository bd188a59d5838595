import { createSignal, For, Show } from "solid-js";
import { useStation } from "../../console";
import type { SiteView, StationView } from "../../protocol";
import { saveAs } from "../../source/saveAs";
import { text } from "../../text/catalogue";
import { formatAge, formatBytes, formatQuantity, UNKNOWN } from "../../text/quantities";
import { formatLength } from "../../text/units";
import { AppAddress } from "../links/AppAddress";
import { SharedAddress } from "../login/SharedAddress";
import { Panel } from "../Panel";
import { SeparationSwitch } from "../separation/SeparationHold";

/** The station and its site. */
export function StationPanel() {
  const { fleet } = useStation();
  return (
    <Panel title={text.station.title} name="station">
      <Show when={fleet.station} fallback={<p class="panel-empty">{text.station.noData}</p>}>
        {(station) => <StationFacts station={station()} />}
      </Show>
      <Show when={fleet.station}>
        {(station) => (
          <section class="section" aria-label={text.separation.name}>
            <p>
              {text.separation.state(
                <strong>
                  {station().separation_hold_on ? text.separation.on : text.separation.off}
                </strong>,
              )}
            </p>
            <SeparationSwitch />
          </section>
        )}
      </Show>
      <AppAddress />
      <SharedAddress />
      <Show when={fleet.site}>{(site) => <SiteFacts site={site()} />}</Show>
      <Show when={fleet.groundImage}>
        <Download />
      </Show>
    </Panel>
  );
}

function Facts(props: { facts: readonly (readonly [string, string])[] }) {
  return (
    <dl class="facts">
      <For each={props.facts}>
        {([name, value]) => (
          <div class="fact fact-wide">
            <dt>{name}</dt>
            <dd class="wire-text">{value}</dd>
          </div>
        )}
      </For>
    </dl>
  );
}

function StationFacts(props: { station: StationView }) {
  const { behindS } = useStation();
  return (
    <Facts
      facts={[
        [text.station.version, props.station.version],
        [text.station.uptime, formatAge(props.station.uptime_s + behindS())],
        [text.station.appAddress, props.station.link_addresses.join(", ") || UNKNOWN],
        [text.station.framesDropped, String(props.station.frames_dropped)],
        [text.station.rawCapture, props.station.capture_folder ?? text.station.captureOff],
        ...losses(props.station),
      ]}
    />
  );
}

/** Refused connections and lost capture data; empty without any. */
function losses(station: StationView): (readonly [string, string])[] {
  const facts: (readonly [string, string])[] = [];
  if (station.connections_refused > 0) {
    facts.push([text.station.refused, String(station.connections_refused)]);
  }
  if (station.capture_dropped_bytes > 0) {
    facts.push([text.station.captureLost, formatBytes(station.capture_dropped_bytes)]);
  }
  return facts;
}

function SiteFacts(props: { site: SiteView }) {
  return (
    <Facts
      facts={[
        [text.station.site, props.site.name],
        [text.station.groundAltitude, formatLength(props.site.ground_altitude_m, 1)],
        [
          text.station.terrain,
          props.site.terrain === "model" ? text.station.elevationModel : text.station.flat,
        ],
        [text.station.maxHeight, formatLength(props.site.limits.max_height_above_ground_m, 1)],
        [text.station.maxDistance, formatLength(props.site.limits.max_distance_from_home_m, 1)],
        [text.station.imagers, props.site.imager_serials.join(", ") || UNKNOWN],
        [text.station.poseError, formatQuantity(props.site.pose_rms_px, "px", 2)],
        [text.station.poseHeight, formatLength(props.site.pose_height_m, 1)],
      ]}
    />
  );
}

/** Saves the ground image as GeoTIFF. */
function Download() {
  const { source } = useStation();
  const [problem, setProblem] = createSignal<string | null>(null);
  const save = async () => {
    const outcome = await source.light.groundImageFile();
    setProblem(outcome.kind === "failed" ? outcome.problem : null);
    if (outcome.kind === "answered") saveAs(outcome.value.blob, "ground-image.tif");
  };
  return (
    <div class="row">
      <button type="button" class="button" onClick={() => void save()}>
        {text.station.saveGroundImage}
      </button>
      <Show when={problem()}>{(why) => <p class="tone-error">{why()}</p>}</Show>
    </div>
  );
}
