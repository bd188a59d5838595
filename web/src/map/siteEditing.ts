import type { Map as MapLibre, MapMouseEvent } from "maplibre-gl";
import { createEffect, createMemo, createSignal, on, onCleanup } from "solid-js";
import type { SiteDraft } from "../site/siteDraft";
import { areaHa, type DraftFeature, isDraggable } from "../site/siteFeatures";
import type { ThemeSwitch } from "../theme/theme";
import { readColours } from "./colours";
import type { RingEditor } from "./ringEditor";
import { DRAFT_FILL, DRAFT_POINT, layerColour } from "./siteDraftLayer";

/** A press this near a corner of the selected feature is meant for the corner. */
const CORNER_PX = 24;

/**
 * Editing the site with a pointer: a press selects a feature, whose rings are then edited by the ring editor;
 * with a tool, presses draw a new ring. The editor's library is loaded when it is first needed.
 */
export function createSiteEditing(map: MapLibre, draft: SiteDraft, theme: ThemeSwitch): void {
  const [editor, setEditor] = createSignal<RingEditor | null>(null);
  let isGone = false;
  let isAsked = false;
  createEffect(() => {
    if (!draft.isOn() || isAsked) return;
    isAsked = true;
    void import("./ringEditor").then(({ RingEditor }) => {
      if (isGone) return;
      const changed = (index: number, ring: DraftFeature["rings"][number]) => {
        const one = draft.selected();
        if (one !== null) draft.setRing(one.id, index, ring);
      };
      setEditor(new RingEditor(map, { drawn: draft.finish, changed }));
    });
  });
  onCleanup(() => {
    isGone = true;
    editor()?.stop();
  });

  const edited = createMemo(() => {
    const one = draft.isOn() ? draft.selected() : null;
    return one !== null && isDraggable(one) ? one : null;
  });
  createEffect(() => {
    const [ringEditor, tool, one] = [editor(), draft.isOn() ? draft.tool() : null, edited()];
    theme.changes();
    if (ringEditor === null) return;
    const colours = readColours(document);
    const layer = tool?.layer ?? one?.layer ?? "boundary";
    ringEditor.recolour({ line: layerColour(layer, colours), casing: colours.casing });
    if (tool !== null) ringEditor.draw(tool.layer === "landing_pads" ? "point" : "polygon");
    else if (one !== null) ringEditor.edit(one);
    else ringEditor.rest();
  });

  const select = (event: MapMouseEvent) => {
    if (!draft.isOn() || draft.tool() !== null) return;
    const one = draft.selected();
    if (one !== null && isDraggable(one) && isNearCorner(map, one, event)) return;
    const hits = map.queryRenderedFeatures(event.point, { layers: [DRAFT_FILL, DRAFT_POINT] });
    const hit = (key: string) => new Set(hits.map(({ properties }) => properties[key]));
    const [ids, indexes] = [hit("id"), hit("importIndex")];
    const read = smallest(draft.imported().filter((_, index) => indexes.has(index)));
    if (read !== undefined) {
      draft.takeOrLeave(draft.imported().indexOf(read));
      return;
    }
    const found = smallest(draft.features().filter(({ id }) => ids.has(id)));
    if (found !== undefined) draft.select(found.id);
  };
  map.on("click", select);
  onCleanup(() => map.off("click", select));
  // While a ring is drawn, Enter on the map would also be a press of a focused button.
  createEffect(on(draft.tool, (tool) => tool !== null && map.getCanvas().focus(), { defer: true }));
}

/** The boundary is under everything: the smallest is meant. */
function smallest<T extends Pick<DraftFeature, "rings">>(hit: readonly T[]): T | undefined {
  return [...hit].sort((a, b) => areaHa(a) - areaHa(b))[0];
}

function isNearCorner(map: MapLibre, { rings }: DraftFeature, { point }: MapMouseEvent): boolean {
  return rings.some((ring) => ring.some((corner) => map.project(corner).dist(point) <= CORNER_PX));
}
