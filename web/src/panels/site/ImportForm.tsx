import { createSignal, For, Show } from "solid-js";
import { useConsole } from "../../console";
import type { LayerName } from "../../protocol";
import type { ImportChoice } from "../../site/siteDraft";
import { areaHa, LAYER_NAMES, LAYERS } from "../../site/siteFeatures";
import { text } from "../../text/catalogue";
import { formatQuantity } from "../../text/quantities";
import { FileButton } from "../FileButton";
import { NoticeLine } from "./NoticeLine";

const EXCLUDED = "";

/** A file of another program: read by the station, shown dotted on the map, and added as it is chosen here. */
export function ImportForm() {
  const { siteDraft } = useConsole();
  const [isOver, setOver] = createSignal(false);
  const { imported, isBusy, notice } = siteDraft;
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
      <NoticeLine notice={notice()?.about === "import" ? notice() : null} />
      <Show when={imported().length > 0}>
        <p class="muted">{text.imports.choose}</p>
        <ul aria-label={text.imports.list}>
          <For each={imported()}>{(one, index) => <Choice choice={one} index={index()} />}</For>
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

function Choice(props: { choice: ImportChoice; index: number }) {
  const { siteDraft } = useConsole();
  const fitting = () =>
    LAYER_NAMES.filter((layer) => LAYERS[layer].isPoint === props.choice.isPoint);
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
