import {
  createEffect,
  createResource,
  createSignal,
  For,
  Index,
  on,
  onMount,
  Show,
} from "solid-js";
import { useSiteEditing, useStation } from "../../console";
import type { SiteVehicleView } from "../../protocol";
import { valuesOf } from "../../protocol/values";
import { text } from "../../text/catalogue";
import { colourOf, lookClasses } from "../../theme/theme";
import { Empty, Panel, Problem } from "../Panel";
import { SaveSection } from "./SaveSection";
import "./vehicles.css";

const columns = text.siteVehicles;

const REFERENCES = valuesOf(text.siteVehicles.references);

/** The site's vehicles as a table: connected or not, edited, checked, saved, and in force without a restart. */
export function VehiclesPanel() {
  const { fleet } = useStation();
  const { vehicleTable: table } = useSiteEditing();
  onMount(() => void table.open());
  // What may change depends on what flies.
  createEffect(
    on(
      () => fleet.vehicles.filter(({ is_flying }) => is_flying.value !== false).length,
      () => table.recheck(),
      { defer: true },
    ),
  );
  const reason = () => table.saved()?.locked_reason ?? null;
  return (
    <Panel
      title={text.panels.titles.vehicles}
      name="vehicles"
      class="site site-vehicles"
      count={table.rows().length}
    >
      <Show when={table.saved() === null && !table.isBusy()}>
        <div class="section">
          <Problem text={table.notice()?.text ?? null} />
        </div>
      </Show>
      <Show when={reason()}>
        {(why) => (
          <div class="section">
            <Problem text={why()} />
          </div>
        )}
      </Show>
      <Show when={table.saved()} fallback={<Empty>{text.siteVehicles.loading}</Empty>}>
        <Show when={table.rows().length > 0} fallback={<Empty>{text.siteVehicles.none}</Empty>}>
          <Rows />
        </Show>
        <AddVehicle />
        <Save />
      </Show>
    </Panel>
  );
}

function Rows() {
  const { source } = useStation();
  const { vehicleTable: table } = useSiteEditing();
  const [cameras] = createResource(async () => {
    const outcome = await source.surveys.cameras();
    return outcome.kind === "answered" ? outcome.value : [];
  });
  return (
    <table class="vehicle-table" aria-label={text.siteVehicles.table}>
      <thead>
        <tr>
          <For
            each={[
              columns.vehicle,
              columns.number,
              columns.name,
              columns.reference,
              columns.camera,
            ]}
          >
            {(title) => <th scope="col">{title}</th>}
          </For>
          <th scope="col">
            <span class="hidden-but-read">{columns.remove}</span>
          </th>
        </tr>
      </thead>
      <tbody>
        <Index each={table.rows()}>
          {(row, index) => <Row row={row()} index={index} cameras={cameras() ?? []} />}
        </Index>
      </tbody>
    </table>
  );
}

function Row(props: {
  row: SiteVehicleView;
  index: number;
  cameras: readonly { readonly name: string; readonly title: string }[];
}) {
  const { fleet } = useStation();
  const { vehicleTable: table } = useSiteEditing();
  const serial = () => props.row.serial;
  const set = (change: Partial<SiteVehicleView>) => table.edit(props.index, change);
  const state = () => {
    const known = fleet.vehicles.find((vehicle) => vehicle.serial === serial());
    if (known === undefined) return text.siteVehicles.notConnected;
    return known.is_imager ? text.siteVehicles.imager : text.siteVehicles.connected;
  };
  const problem = () => {
    const verdict = table.verdict();
    return verdict.kind === "refused" && verdict.row === props.index ? verdict.text : null;
  };
  const number = () => props.row.number ?? 0;
  const isUnknownCamera = () =>
    (props.row.camera ?? null) !== null &&
    !props.cameras.some(({ name }) => name === props.row.camera);
  return (
    <tr aria-label={serial()} classList={{ "is-wrong": problem() !== null }}>
      <th scope="row">
        <div class="wire-text">{serial()}</div>
        <div class="muted">{state()}</div>
        <Problem text={problem()} />
      </th>
      <td data-label={columns.number}>
        <div class="vehicle-number own-colour" style={{ "--own": colourOf(number()) }}>
          <span class={`badge ${lookClasses(number())}`} aria-hidden="true">
            {number() || "?"}
          </span>
          <input
            class="field"
            inputmode="numeric"
            aria-label={text.siteVehicles.numberOf(serial())}
            placeholder={text.siteVehicles.automatic}
            value={props.row.number ?? ""}
            onChange={(event) => {
              const typed = event.currentTarget.value.trim();
              const value = Number(typed);
              if (typed !== "" && !Number.isInteger(value)) {
                // The browser keeps the text: the value in force is shown again.
                event.currentTarget.value = String(props.row.number ?? "");
                return;
              }
              set({ number: typed === "" ? null : value });
            }}
          />
        </div>
      </td>
      <td data-label={columns.name}>
        <input
          class="field"
          aria-label={text.siteVehicles.nameOf(serial())}
          placeholder={serial()}
          value={props.row.name ?? ""}
          onChange={(event) => set({ name: event.currentTarget.value.trim() || null })}
        />
      </td>
      <td data-label={columns.reference}>
        <select
          class="field"
          aria-label={text.siteVehicles.referenceOf(serial())}
          value={props.row.waypoint_altitude ?? "unset"}
          onChange={({ currentTarget: { value } }) => {
            const reference = REFERENCES.find((one) => one === value) ?? "unset";
            set({ waypoint_altitude: reference === "unset" ? null : reference });
          }}
        >
          <For each={REFERENCES}>
            {(name) => <option value={name}>{text.siteVehicles.references[name]}</option>}
          </For>
        </select>
      </td>
      <td data-label={columns.camera}>
        <select
          class="field"
          aria-label={text.siteVehicles.cameraOf(serial())}
          onChange={(event) => set({ camera: event.currentTarget.value || null })}
        >
          <option value="">{text.siteVehicles.noCamera}</option>
          <Show when={isUnknownCamera()}>
            <option value={props.row.camera ?? ""} selected>
              {props.row.camera}
            </option>
          </Show>
          <For each={props.cameras}>
            {({ name, title }) => (
              <option value={name} selected={name === props.row.camera}>
                {title}
              </option>
            )}
          </For>
        </select>
      </td>
      <td>
        <button
          type="button"
          class="button button-quiet"
          aria-label={text.siteVehicles.removeOf(serial())}
          title={text.siteVehicles.removeHint}
          onClick={() => table.remove(props.index)}
        >
          ✕
        </button>
      </td>
    </tr>
  );
}

/** A row by serial, and one for each connected vehicle that the site does not list. */
function AddVehicle() {
  const { fleet } = useStation();
  const { vehicleTable: table } = useSiteEditing();
  const [serial, setSerial] = createSignal("");
  const listed = () => new Set(table.rows().map((row) => row.serial));
  const unlisted = () =>
    fleet.vehicles.filter((vehicle) => vehicle.serial !== null && !listed().has(vehicle.serial));
  const isListed = () => listed().has(serial().trim());
  return (
    <section class="section" aria-label={text.siteVehicles.add}>
      <Show when={unlisted().length > 0}>
        <p class="muted">{text.siteVehicles.notListed}</p>
        <div class="section-buttons">
          <For each={unlisted()}>
            {(vehicle) => (
              <button type="button" class="button" onClick={() => table.add(vehicle.serial ?? "")}>
                {text.siteVehicles.addOf(<span class="wire-text">{vehicle.serial}</span>)}
              </button>
            )}
          </For>
        </div>
      </Show>
      <form
        class="vehicle-add"
        aria-label={text.siteVehicles.bySerial}
        onSubmit={(event) => {
          event.preventDefault();
          table.add(serial().trim());
          setSerial("");
        }}
      >
        <label>
          {text.siteVehicles.serial}
          <input
            class="field"
            value={serial()}
            onInput={(event) => setSerial(event.currentTarget.value)}
          />
        </label>
        <button
          type="submit"
          class="button"
          disabled={serial().trim() === "" || isListed()}
          title={isListed() ? text.siteVehicles.isListed : undefined}
        >
          {text.siteVehicles.addButton}
        </button>
      </form>
    </section>
  );
}

function Save() {
  const { vehicleTable: table } = useSiteEditing();
  const isElsewhere = () => {
    const verdict = table.verdict();
    return verdict.kind === "refused" && verdict.row !== null;
  };
  return (
    <SaveSection
      title={text.siteVehicles.save}
      checking={text.siteVehicles.checking}
      draft={table}
      needs="admin"
      isElsewhere={isElsewhere()}
    />
  );
}
