import { createSignal, For, Show } from "solid-js";
import { useConsole } from "../../console";
import type { LayerName } from "../../protocol";
import type { ImportChoice } from "../../site/siteDraft";
import { areaHa, LAYER_NAMES, LAYERS } from "../../site/siteFeatures";
import { plural } from "../../text/names";
import { formatQuantity } from "../../text/quantities";
import { NoticeLine } from "./NoticeLine";

const ACCEPTED = ".kml,.kmz,.zip,.gpkg,.geojson,.json";
const LEFT_OUT = "";

/** A file of another program: read by the station, shown dotted on the map, and added as it is chosen here. */
export function ImportForm() {
  const { siteDraft } = useConsole();
  const [isOver, setOver] = createSignal(false);
  const { imported, isBusy, notice } = siteDraft;
  const read = (files: FileList | null) => {
    const file = files?.[0];
    if (file !== undefined) void siteDraft.readFile(file);
  };
  const added = () => imported().filter(({ layer }) => layer !== null).length;
  return (
    <section
      class="section site-import"
      classList={{ "is-over": isOver() }}
      aria-label="Import"
      onDragOver={(event) => {
        event.preventDefault();
        setOver(true);
      }}
      onDragLeave={() => setOver(false)}
      onDrop={(event) => {
        event.preventDefault();
        setOver(false);
        read(event.dataTransfer?.files ?? null);
      }}
    >
      <label class="button site-file">
        Import a file
        <input
          class="hidden-but-read"
          type="file"
          accept={ACCEPTED}
          disabled={isBusy()}
          onChange={(event) => {
            read(event.currentTarget.files);
            // The same file may be chosen again after a change.
            event.currentTarget.value = "";
          }}
        />
      </label>
      <p class="muted">KML, KMZ, Shapefile (zip), GeoPackage or GeoJSON; or drop it here.</p>
      <NoticeLine notice={notice()?.about === "import" ? notice() : null} />
      <Show when={imported().length > 0}>
        <p class="muted">
          Choose what each becomes. A press on its shape takes it or leaves it out.
        </p>
        <ul aria-label="Imported features">
          <For each={imported()}>{(one, index) => <Choice choice={one} index={index()} />}</For>
        </ul>
        <div class="section-buttons">
          <button
            type="button"
            class="button site-save"
            disabled={added() === 0}
            onClick={() => siteDraft.addImported()}
          >
            Add {plural(added(), "feature")}
          </button>
          <button type="button" class="button" onClick={() => siteDraft.dropImported()}>
            Leave out all
          </button>
        </div>
      </Show>
    </section>
  );
}

function Choice(props: { choice: ImportChoice; index: number }) {
  const { siteDraft } = useConsole();
  const fitting = () =>
    LAYER_NAMES.filter((layer) => LAYERS[layer].isPoint === props.choice.isPoint);
  const name = () => props.choice.name || `Feature ${props.index + 1}`;
  return (
    <li>
      <label class="site-choice">
        <span class="wire-text">
          {name()}
          <Show when={!props.choice.isPoint}>
            <span class="muted"> {formatQuantity(areaHa(props.choice), "ha", 2)}</span>
          </Show>
        </span>
        <select
          class="field"
          value={props.choice.layer ?? LEFT_OUT}
          onChange={(event) =>
            siteDraft.choose(
              props.index,
              event.currentTarget.value === LEFT_OUT
                ? null
                : (event.currentTarget.value as LayerName),
            )
          }
        >
          <For each={fitting()}>
            {(layer) => <option value={layer}>{LAYERS[layer].name}</option>}
          </For>
          <option value={LEFT_OUT}>Leave out</option>
        </select>
      </label>
    </li>
  );
}
