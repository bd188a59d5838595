import { createEffect, createSignal, For, onCleanup, Show } from "solid-js";
import { useMapModes, useSiteEditing } from "../../console";
import type { LayerName } from "../../protocol";
import {
  areaHa,
  type DraftFeature,
  featureName,
  LAYER_NAMES,
  LAYERS,
} from "../../site/siteFeatures";
import { text } from "../../text/catalogue";
import { formatQuantity } from "../../text/quantities";
import { Empty, Panel, Problem } from "../Panel";
import { FeatureForm } from "./FeatureForm";
import { ImportForm } from "./ImportForm";
import { SaveSection } from "./SaveSection";
import "./site.css";

/** What a shape without a pointer takes of the map's width. */
const SQUARE_SHARE = 0.4;

/** The site's boundary, zones, regions and pads: drawn, checked, saved, and in force without a restart. */
export function SitePanel() {
  const { fit } = useMapModes();
  const { siteDraft } = useSiteEditing();
  // Without its panel the draft would lie over the fences in force; edits are kept.
  onCleanup(() => siteDraft.leave());
  const toggle = async () => {
    await siteDraft.toggle();
    if (siteDraft.isOn() && siteDraft.features().length > 0) fit();
  };
  return (
    <Panel
      title={text.panels.titles.site}
      name="site"
      class="site"
      actions={
        <button type="button" class="button" onClick={() => void toggle()}>
          {siteDraft.isOn() ? text.site.close : text.site.edit}
        </button>
      }
    >
      <Show
        when={siteDraft.isOn()}
        fallback={<Empty>{siteDraft.isChanged() ? text.site.unsaved : text.site.what}</Empty>}
      >
        <Editor />
      </Show>
    </Panel>
  );
}

function Editor() {
  const { siteDraft } = useSiteEditing();
  const { saved, features, selected } = siteDraft;
  warnBeforeUnload(siteDraft.isChanged);
  return (
    <>
      <Show when={saved()?.locked_reason}>
        {(reason) => (
          <div class="section">
            <Problem text={reason()} />
          </div>
        )}
      </Show>
      <Show when={saved() === null}>
        <Empty>{text.site.loading}</Empty>
      </Show>
      {/* What cannot be saved is not begun; what was begun before stays to be read. */}
      <Show when={saved()?.locked_reason === null || siteDraft.isChanged()}>
        <AddForm />
        <Show when={features().length > 0} fallback={<Empty>{text.site.empty}</Empty>}>
          <ul class="list" aria-label={text.site.features}>
            <For each={LAYER_NAMES}>
              {(layer) => (
                <For each={features().filter((one) => one.layer === layer)}>
                  {(feature) => <FeatureRow feature={feature} />}
                </For>
              )}
            </For>
          </ul>
        </Show>
        {/* By id: what was typed for one feature is not shown for the next. */}
        <Show when={selected()?.id} keyed>
          <Show when={selected()}>{(feature) => <FeatureForm feature={feature()} />}</Show>
        </Show>
        <ImportForm />
        <Save />
      </Show>
    </>
  );
}

/** Draws on the map, or adds a shape at its centre for those who use no pointer. */
function AddForm() {
  const { mapCentre } = useMapModes();
  const { siteDraft } = useSiteEditing();
  const [layer, setLayer] = createSignal<LayerName>("boundary");
  const tool = siteDraft.tool;
  const isDrawing = () => tool()?.hole === false;
  const add = () => {
    const centre = mapCentre();
    if (centre !== null) siteDraft.addAt(layer(), centre, centre.width_m * SQUARE_SHARE);
  };
  return (
    <form
      class="section site-form"
      aria-label={text.site.newFeature}
      onSubmit={(event) => {
        event.preventDefault();
        siteDraft.draw(isDrawing() ? null : { layer: layer(), hole: false });
      }}
    >
      <label class="site-wide">
        {text.site.add}
        <select
          class="field"
          value={layer()}
          onChange={(event) => setLayer(event.currentTarget.value as LayerName)}
        >
          <For each={LAYER_NAMES}>
            {(name) => <option value={name}>{text.siteLayers[name].name}</option>}
          </For>
        </select>
      </label>
      <button type="submit" class="button" aria-pressed={isDrawing()}>
        {text.site.draw}
      </button>
      <button type="button" class="button" onClick={add}>
        {text.site.atCentre}
      </button>
      <Show when={tool()}>
        {(inHand) => (
          <p class="site-wide" role="status">
            {hint(inHand())}
          </p>
        )}
      </Show>
    </form>
  );
}

function hint({ layer, hole }: { layer: LayerName; hole: boolean }): string {
  if (LAYERS[layer].isPoint) return text.site.pressPlace;
  return hole ? text.site.pressHoleCorners : text.site.pressCorners(text.siteLayers[layer].one);
}

function FeatureRow(props: { feature: DraftFeature }) {
  const { siteDraft } = useSiteEditing();
  const isSelected = () => siteDraft.selected()?.id === props.feature.id;
  const problem = () => {
    const verdict = siteDraft.verdict();
    const isMine = verdict.kind === "refused" && verdict.featureId === props.feature.id;
    return isMine ? verdict.text : null;
  };
  return (
    <li class="row site-row">
      <button
        type="button"
        class="button button-quiet site-pick"
        aria-pressed={isSelected()}
        onClick={() => siteDraft.select(isSelected() ? null : props.feature.id)}
      >
        <span class={`site-swatch site-swatch-${props.feature.layer}`} aria-hidden="true" />
        <span class="wire-text">
          {featureName(props.feature)}
          <span class="muted"> {facts(props.feature)}</span>
        </span>
      </button>
      <Problem text={problem()} />
    </li>
  );
}

/** What it is, unless it is named so, and how large: `Survey region, 4.2 ha, 1 hole`. */
function facts(feature: DraftFeature): string {
  const { isPoint } = LAYERS[feature.layer];
  const { name } = text.siteLayers[feature.layer];
  const isNamedSo = featureName(feature).toLowerCase().startsWith(name.toLowerCase());
  const holes = feature.rings.length - 1;
  return [
    ...(isNamedSo ? [] : [name]),
    ...(isPoint ? [] : [formatQuantity(areaHa(feature), "ha", 2)]),
    ...(holes > 0 ? [text.site.holes(holes)] : []),
  ].join(", ");
}

function Save() {
  const { siteDraft } = useSiteEditing();
  const isElsewhere = () => {
    const verdict = siteDraft.verdict();
    return verdict.kind === "refused" && verdict.featureId !== null;
  };
  return (
    <SaveSection
      title={text.site.save}
      checking={text.site.checking}
      draft={siteDraft}
      needs="operator"
      isElsewhere={isElsewhere()}
      edits={siteDraft}
    />
  );
}

/** Asks before the page is left with changes that are not saved. */
function warnBeforeUnload(isChanged: () => boolean): void {
  createEffect(() => {
    if (!isChanged()) return;
    const ask = (event: BeforeUnloadEvent) => event.preventDefault();
    window.addEventListener("beforeunload", ask);
    onCleanup(() => window.removeEventListener("beforeunload", ask));
  });
}
