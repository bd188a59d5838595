import type { Map as MapLibre } from "maplibre-gl";
import { text } from "../text/catalogue";
import { LayersButton } from "./LayersButton";
import type { MapCamera } from "./mapCamera";

/** Buttons on the map: its layers, selection by a band, and what is in view. */
export function MapTools(props: {
  readonly map: MapLibre | null;
  readonly camera: MapCamera;
  readonly isBanding: boolean;
  readonly setBanding: (isBanding: boolean) => void;
}) {
  return (
    <div class="map-tools">
      <LayersButton />
      <button
        type="button"
        class="button map-band"
        aria-pressed={props.isBanding}
        onClick={() => props.setBanding(!props.isBanding)}
        title={text.map.bandHint}
        aria-label={text.map.band}
      >
        <BandIcon />
      </button>
      <button
        type="button"
        class="button"
        onClick={() => props.camera.fit()}
        title={text.map.fitHint}
        aria-label={text.map.fit}
      >
        <FitIcon />
      </button>
      <button
        type="button"
        class="button"
        onClick={() => props.camera.byHand(() => props.map?.zoomIn())}
        aria-label={text.map.zoomIn}
      >
        +
      </button>
      <button
        type="button"
        class="button"
        onClick={() => props.camera.byHand(() => props.map?.zoomOut())}
        aria-label={text.map.zoomOut}
      >
        −
      </button>
    </div>
  );
}

/** A dashed box around a dot. */
function BandIcon() {
  return (
    <svg class="fit-icon" viewBox="0 0 24 24" width="22" height="22" aria-hidden="true">
      <path stroke-dasharray="4 3" d="M4 4h16v16H4z" />
      <path d="M11 12h2" />
    </svg>
  );
}

/** Four corners as SVG: not every font has the sign. */
function FitIcon() {
  return (
    <svg class="fit-icon" viewBox="0 0 24 24" width="22" height="22" aria-hidden="true">
      <path d="M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5" />
    </svg>
  );
}
