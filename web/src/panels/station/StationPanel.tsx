import { createSignal, For, Show } from "solid-js";
import { useConsole } from "../../console";
import type { SiteView, StationView } from "../../protocol";
import { saveAs } from "../../source/saveAs";
import { formatAge, formatBytes, formatQuantity, UNKNOWN } from "../../text/quantities";
import { formatLength } from "../../text/units";
import { AppAddress } from "../links/AppAddress";
import { SharedAddress } from "../login/SharedAddress";
import { Panel } from "../Panel";
import { SeparationSwitch } from "../separation/SeparationHold";

/** The station and its site. */
export function StationPanel() {
  const { fleet } = useConsole();
  return (
    <Panel title="Station" name="station">
      <Show when={fleet.station} fallback={<p class="panel-empty">No data yet.</p>}>
        {(station) => <StationFacts station={station()} />}
      </Show>
      <Show when={fleet.station}>
        {(station) => (
          <section class="section" aria-label="Separation hold">
            <p>
              Separation hold: <strong>{station().separation_hold_on ? "on" : "OFF"}</strong>
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
        {([name, text]) => (
          <div class="fact fact-wide">
            <dt>{name}</dt>
            <dd class="wire-text">{text}</dd>
          </div>
        )}
      </For>
    </dl>
  );
}

function StationFacts(props: { station: StationView }) {
  const { behindS } = useConsole();
  return (
    <Facts
      facts={[
        ["Version", props.station.version],
        ["Uptime", formatAge(props.station.uptime_s + behindS())],
        ["App address", props.station.link_addresses.join(", ") || UNKNOWN],
        ["Frames dropped", String(props.station.frames_dropped)],
        ["Raw capture", props.station.capture_folder ?? "off"],
        ...losses(props.station),
      ]}
    />
  );
}

/** Refused connections and lost capture data; empty without any. */
function losses(station: StationView): (readonly [string, string])[] {
  const facts: (readonly [string, string])[] = [];
  if (station.connections_refused > 0) {
    facts.push(["Connections refused", String(station.connections_refused)]);
  }
  if (station.capture_dropped_bytes > 0) {
    facts.push(["Lost from raw capture", formatBytes(station.capture_dropped_bytes)]);
  }
  return facts;
}

function SiteFacts(props: { site: SiteView }) {
  return (
    <Facts
      facts={[
        ["Site", props.site.name],
        ["Ground altitude, WGS84", formatLength(props.site.ground_altitude_m, 1)],
        ["Terrain", props.site.terrain === "model" ? "elevation model" : "assumed flat"],
        ["Max. height above ground", formatLength(props.site.limits.max_height_above_ground_m, 1)],
        ["Max. distance from home", formatLength(props.site.limits.max_distance_from_home_m, 1)],
        ["Imaging drones", props.site.imager_serials.join(", ") || UNKNOWN],
        ["Camera pose error, RMS", formatQuantity(props.site.pose_rms_px, "px", 2)],
        ["Camera pose height above ground", formatLength(props.site.pose_height_m, 1)],
      ]}
    />
  );
}

/** Saves the ground image as GeoTIFF. */
function Download() {
  const { source } = useConsole();
  const [problem, setProblem] = createSignal<string | null>(null);
  const save = async () => {
    const outcome = await source.groundImageFile();
    setProblem(outcome.kind === "failed" ? outcome.problem : null);
    if (outcome.kind === "answered") saveAs(outcome.value.blob, "ground-image.tif");
  };
  return (
    <div class="row">
      <button type="button" class="button" onClick={() => void save()}>
        Save ground image (GeoTIFF)
      </button>
      <Show when={problem()}>{(text) => <p class="tone-error">{text()}</p>}</Show>
    </div>
  );
}
