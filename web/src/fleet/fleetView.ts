import { createComputed } from "solid-js";
import { createStore, reconcile } from "solid-js/store";
import type {
  AlarmView,
  CommandView,
  FleetReturnView,
  GroundImageView,
  ImagerReliefView,
  LightSensorsView,
  LinkView,
  MoveUpwindView,
  ShadeLineView,
  SideStepView,
  SiteView,
  StationView,
  StopLatchView,
  SurveyView,
  TemporaryZoneView,
  VehicleView,
} from "../protocol";
import type { StationSource } from "../source/stationSource";
import { vehicleKey } from "./vehicleStatus";

/** The newest state for the panels, without tracks: only the map reads those, from the source. */
export type FleetView = Readonly<FleetData>;

type KeyedVehicle = VehicleView & { readonly key: number };

interface FleetData {
  hasState: boolean;
  vehicles: KeyedVehicle[];
  links: LinkView[];
  commands: CommandView[];
  alarms: AlarmView[];
  station: StationView | null;
  /** The all stop in force. */
  stopLatch: StopLatchView | null;
  site: SiteView | null;
  groundImage: GroundImageView | null;
  fleetReturn: FleetReturnView | null;
  sideStep: SideStepView | null;
  moveUpwind: MoveUpwindView | null;
  imagerRelief: ImagerReliefView | null;
  shade: ShadeLineView | null;
  lightSensors: LightSensorsView | null;
  surveys: SurveyView[];
  temporaryZones: TemporaryZoneView[];
}

const NO_DATA: FleetData = {
  hasState: false,
  vehicles: [],
  links: [],
  commands: [],
  alarms: [],
  station: null,
  stopLatch: null,
  site: null,
  groundImage: null,
  fleetReturn: null,
  sideStep: null,
  moveUpwind: null,
  imagerRelief: null,
  shade: null,
  lightSensors: null,
  surveys: [],
  temporaryZones: [],
};

/**
 * Mirrors the source's state in a store. Rows are matched by their ids, so that a button being held is
 * never replaced.
 */
export function createFleetView(source: Pick<StationSource, "state">): FleetView {
  const [view, setView] = createStore<FleetData>({ ...NO_DATA });
  createComputed(() => {
    const state = source.state();
    if (state === null) return;
    const vehicles = state.vehicles.map((vehicle) => ({
      ...vehicle,
      track: [],
      key: vehicleKey(vehicle),
    }));
    setView("hasState", true);
    setView("vehicles", reconcile(vehicles, { key: "key" }));
    setView("links", reconcile([...state.links], { key: "id" }));
    setView("commands", reconcile([...state.commands], { key: "id" }));
    setView("alarms", reconcile([...state.alarms], { key: "id" }));
    setView("station", reconcile(state.station));
    setView("stopLatch", reconcile(state.stop_latch));
    setView("temporaryZones", reconcile([...state.temporary_zones], { key: "id" }));
    setView("site", reconcile(state.site));
    setView("fleetReturn", reconcile(state.fleet_return, { key: "serial" }));
    setView("sideStep", reconcile(state.side_step));
    setView("moveUpwind", reconcile(state.move_upwind));
    setView("imagerRelief", reconcile(state.imager_relief));
    setView("shade", reconcile(state.shade));
    setView("lightSensors", reconcile(state.light_sensors, { key: "name" }));
    setView("surveys", reconcile([...state.surveys], { key: "id" }));
    setView("groundImage", reconcile(state.ground_image));
  });
  return view;
}
