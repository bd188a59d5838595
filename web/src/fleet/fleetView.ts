import { createComputed } from "solid-js";
import { createStore, reconcile } from "solid-js/store";
import type {
  AlarmView,
  CommandView,
  FleetReturnView,
  GroundImageView,
  LinkView,
  ShadeLineView,
  SiteView,
  StationView,
  SurveyView,
  VehicleView,
} from "../protocol";
import type { StationSource } from "../source/stationSource";
import { vehicleKey } from "./vehicleStatus";

/** The newest state for the panels. Tracks are left out: only the map reads them, from the source. */
export type FleetView = Readonly<Contents>;

type KeyedVehicle = VehicleView & { readonly key: number };

interface Contents {
  hasState: boolean;
  vehicles: KeyedVehicle[];
  links: LinkView[];
  commands: CommandView[];
  alarms: AlarmView[];
  station: StationView | null;
  site: SiteView | null;
  groundImage: GroundImageView | null;
  fleetReturn: FleetReturnView | null;
  shade: ShadeLineView | null;
  surveys: SurveyView[];
}

const NOTHING: Contents = {
  hasState: false,
  vehicles: [],
  links: [],
  commands: [],
  alarms: [],
  station: null,
  site: null,
  groundImage: null,
  fleetReturn: null,
  shade: null,
  surveys: [],
};

/**
 * Keeps a store in step with the source. Rows are matched by what identifies them, so that a button
 * one is holding is never replaced by a new one.
 */
export function createFleetView(source: Pick<StationSource, "state">): FleetView {
  const [view, setView] = createStore<Contents>({ ...NOTHING });
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
    setView("site", reconcile(state.site));
    setView("fleetReturn", reconcile(state.fleet_return, { key: "serial" }));
    setView("shade", reconcile(state.shade));
    setView("surveys", reconcile([...state.surveys], { key: "id" }));
    setView("groundImage", reconcile(state.ground_image));
  });
  return view;
}
