import { Show } from "solid-js";
import { useMapModes, useStation } from "../console";
import { text } from "../text/catalogue";
import { listNames, vehicleLabel } from "../text/names";
import { positionOf } from "./scene";

/** The name and source of the base map, as its licence asks. */
export function BaseMapNote() {
  const { baseMaps } = useMapModes();
  return (
    <Show when={baseMaps.shown()}>
      {(base) => (
        <p class="map-note wire-text">
          {text.map.base(
            [base().title, base().attribution].filter((part) => part !== "").join(", "),
          )}
        </p>
      )}
    </Show>
  );
}

/** Lists vehicles that cannot be drawn on the map. */
export function UnplacedNote() {
  const { source } = useStation();
  const unplaced = () =>
    (source.state()?.vehicles ?? []).filter((vehicle) => positionOf(vehicle) === null);
  return (
    <Show when={unplaced().length > 0}>
      <p class="map-note wire-text">{text.map.unplaced(listNames(unplaced().map(vehicleLabel)))}</p>
    </Show>
  );
}
