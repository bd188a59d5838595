import type { Feature } from "geojson";
import type { Map as MapLibre } from "maplibre-gl";
import { vehicleKey } from "../fleet/vehicleStatus";
import type { VehicleView } from "../protocol";
import { vehicleLabel } from "../text/names";
import { formatQuantity } from "../text/quantities";
import { colourOf } from "../theme/theme";
import type { Colours } from "./colours";
import { addFeatures, lineFeature, setFeatures } from "./features";
import { type Layer, positionOf, type Scene } from "./scene";
import { TargetMarkers } from "./targetMarkers";

const SOURCE = "steering";
const WAY = "steering-way";

/** Targets of vehicles under virtual stick control: a ring at each, and the line to it. */
export class SteeringLayer implements Layer {
  private map: MapLibre | null = null;
  private colours: Colours | null = null;
  private hasWays = false;
  private readonly targets = new TargetMarkers();

  add(map: MapLibre, colours: Colours): void {
    this.map = map;
    this.colours = colours;
    addFeatures(map, SOURCE);
    map.addLayer({
      id: WAY,
      type: "line",
      source: SOURCE,
      paint: { "line-color": ["get", "colour"], "line-width": 3, "line-dasharray": [1, 1.5] },
    });
  }

  update(scene: Scene): void {
    const { map, colours } = this;
    if (map === null || colours === null) return;
    const steered = scene.state.vehicles.filter((vehicle) => vehicle.steering !== null);
    this.targets.show(map, steered.flatMap(targetOf));
    if (steered.length === 0 && !this.hasWays) return;
    this.hasWays = steered.length > 0;
    setFeatures(
      map,
      SOURCE,
      steered.flatMap((vehicle) => wayOf(vehicle, colours) ?? []),
    );
  }

  recolour(colours: Colours): void {
    this.colours = colours;
  }
}

function targetOf(vehicle: VehicleView) {
  const { steering } = vehicle;
  if (steering === null) return [];
  const height = formatQuantity(steering.height_above_takeoff_m, "m", 0);
  const action = steering.has_arrived ? "holding here" : "flying here";
  return [
    {
      key: vehicleKey(vehicle),
      at: { lon: steering.longitude_deg, lat: steering.latitude_deg },
      colour: colourOf(vehicleKey(vehicle)),
      text: `${vehicleLabel(vehicle)} ${action}, ↥ ${height}`,
    },
  ];
}

function wayOf(vehicle: VehicleView, colours: Colours): Feature | null {
  const here = positionOf(vehicle);
  const { steering } = vehicle;
  if (here === null || steering === null) return null;
  return lineFeature(
    [
      [here.lon, here.lat],
      [steering.longitude_deg, steering.latitude_deg],
    ],
    { colour: colours.vehicle(vehicle.number) },
  );
}
