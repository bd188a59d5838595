import { createSignal, For, Show } from "solid-js";
import { useSiteEditing } from "../../console";
import type { LayerName } from "../../protocol";
import type { ImportChoice } from "../../site/siteDraft";
import { areaHa, LAYER_NAMES, LAYERS } from "../../site/siteFeatures";
import { text } from "../../text/catalogue";
import { formatQuantity } from "../../text/quantities";
import { FileButton } from "../FileButton";
import { NoticeLine } from "./NoticeLine";

const EXCLUDED = "";
/** More features than are looked through by eye, and excluded ones that are shown unfolded. */
const MANY = 20;
const FEW = 5;

/** A file of another program: read by the station, shown dotted on the map, and added as it is chosen here. */
export function ImportForm() {
  const { siteDraft } = useSiteEditing();
  const [isOver, setOver] = createSignal(false);
  const [search, setSearch] = createSignal("");
  const { imported, isBusy, notice } = siteDraft;
  const isFound = ({ name }: ImportChoice) =>
    name.toLowerCase().includes(search().trim().toLowerCase());
  const added = () => imported().filter(({ layer }) => layer !== null).length;
  return (
    <section
      class="section site-import"
      classList={{ "is-over": isOver() }}
      aria-label={text.imports.name}
      onDragOver={(event) => {
        event.preventDefault();
        setOver(true);
      }}
      onDragLeave={() => setOver(false)}
      onDrop={(event) => {
        event.preventDefault();
        setOver(false);
        const file = event.dataTransfer?.files[0];
        if (file !== undefined) void siteDraft.readFile(file);
      }}
    >
      <FileButton
        label={text.imports.file}
        disabled={isBusy()}
        onFile={(file) => void siteDraft.readFile(file)}
      />
      <p class="muted">{text.imports.formats}</p>
      <Show when={isBusy()}>
        <label class="site-reading" role="status">
          {text.imports.reading}
          <progress />
        </label>
      </Show>
      <NoticeLine notice={notice()?.about === "import" ? notice() : null} />
      <Reading />
      <Show when={imported().length > 0}>
        <p class="muted">{text.imports.choose}</p>
        <Show when={imported().length > MANY}>
          <input
            class="field"
            type="search"
            aria-label={text.imports.search}
            placeholder={text.imports.search}
            onInput={(event) => setSearch(event.currentTarget.value)}
          />
        </Show>
        <ul class="import-choices" aria-label={text.imports.list}>
          <For each={imported()}>
            {(one, index) => (
              <Show when={isFound(one)}>
                <Choice choice={one} index={index()} />
              </Show>
            )}
          </For>
        </ul>
        <div class="section-buttons">
          <button
            type="button"
            class="button site-save"
            disabled={added() === 0}
            onClick={() => siteDraft.addImported()}
          >
            {text.imports.add(added())}
          </button>
          <button type="button" class="button" onClick={() => siteDraft.dropImported()}>
            {text.imports.leaveAll}
          </button>
        </div>
      </Show>
    </section>
  );
}

/** What is left out of the file that was read, and what is said about the rest. */
function Reading() {
  const { siteDraft } = useSiteEditing();
  return (
    <Show when={siteDraft.reading()}>
      {(reading) => (
        <>
          <Show when={!reading().isFitForFences}>
            <p class="wire-text">{text.imports.noFences}</p>
          </Show>
          <For each={reading().warnings}>{(line) => <p class="wire-text">{line}</p>}</For>
          <Show when={reading().excluded.length > 0}>
            <details open={reading().excluded.length <= FEW}>
              <summary>
                {text.imports.excluded}: {reading().excluded.length}
              </summary>
              <ul class="import-choices">
                <For each={reading().excluded}>{(line) => <li class="wire-text">{line}</li>}</For>
              </ul>
            </details>
          </Show>
          <Show when={reading().hasOpenPaths}>
            <button
              type="button"
              class="button"
              disabled={siteDraft.isBusy()}
              onClick={() => void siteDraft.readFile(reading().file, true)}
            >
              {text.imports.closePaths}
            </button>
          </Show>
        </>
      )}
    </Show>
  );
}

function Choice(props: { choice: ImportChoice; index: number }) {
  const { siteDraft } = useSiteEditing();
  const fitting = () =>
    LAYER_NAMES.filter(
      (layer) =>
        LAYERS[layer].isPoint === props.choice.isPoint &&
        (layer === "survey_regions" || siteDraft.reading()?.isFitForFences !== false),
    );
  const name = () => props.choice.name || text.imports.unnamed(props.index + 1);
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
          value={props.choice.layer ?? EXCLUDED}
          onChange={(event) =>
            siteDraft.choose(
              props.index,
              event.currentTarget.value === EXCLUDED
                ? null
                : (event.currentTarget.value as LayerName),
            )
          }
        >
          <For each={fitting()}>
            {(layer) => <option value={layer}>{text.siteLayers[layer].name}</option>}
          </For>
          <option value={EXCLUDED}>{text.imports.leave}</option>
        </select>
      </label>
    </li>
  );
}
