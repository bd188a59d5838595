import { createEffect, createMemo, createSignal, For, onCleanup, onMount, Show } from "solid-js";
import { Dynamic } from "solid-js/web";
import { useMapModes, useOrders, usePage, useSiteEditing, useStation } from "./console";
import { happening } from "./fleet/happening";
import { vehicleKey } from "./fleet/vehicleStatus";
import { actOnKey, isAllStop } from "./keys";
import { MapView } from "./map/MapView";
import { createNumberEntry } from "./numberEntry";
import { AlarmList } from "./panels/alarms/AlarmList";
import { SilenceBanner } from "./panels/alarms/SoundControls";
import { ConnectionBanner } from "./panels/bar/ConnectionBanner";
import { TopBar } from "./panels/bar/TopBar";
import { CamerasPanel, LargeCamera } from "./panels/cameras/CamerasPanel";
import { CommandList } from "./panels/commands/CommandList";
import { VehicleDetail } from "./panels/detail/VehicleDetail";
import { FlightsPanel } from "./panels/flights/FlightsPanel";
import { FlyHereCard } from "./panels/fly/FlyHereCard";
import { MissionCard } from "./panels/fly/MissionCard";
import { HelpDialog } from "./panels/help/HelpDialog";
import { LinkList } from "./panels/links/LinkList";
import { LockScreen } from "./panels/lock/LockScreen";
import { LoginDialog } from "./panels/login/LoginDialog";
import type { PanelName } from "./panels/openPanels";
import { AnswerNotice } from "./panels/orders/AnswerNotice";
import { OrderBar } from "./panels/orders/OrderBar";
import { PhotosPanel } from "./panels/photos/PhotosPanel";
import { ReplayBar } from "./panels/replay/ReplayBar";
import { FleetReturn } from "./panels/return/FleetReturn";
import { SeparationBanner } from "./panels/separation/SeparationHold";
import { CalibrationPanel } from "./panels/site/CalibrationPanel";
import { SitePanel } from "./panels/site/SitePanel";
import { VehiclesPanel } from "./panels/site/VehiclesPanel";
import { StationPanel } from "./panels/station/StationPanel";
import { StopBanner } from "./panels/stop/StopLatch";
import { SunPanel } from "./panels/sun/SunPanel";
import { SurveyPanel } from "./panels/survey/SurveyPanel";
import { SurveySummary } from "./panels/survey/SurveySummary";
import { TimeScale } from "./panels/time/TimeScale";
import { TimelinePanel } from "./panels/timeline/TimelinePanel";
import { VehicleList } from "./panels/vehicles/VehicleList";
import { ZonesPanel } from "./panels/zones/ZonesPanel";
import { text } from "./text/catalogue";
import "./layout.css";

const PANELS: readonly (readonly [PanelName, () => ReturnType<typeof AlarmList>])[] = [
  ["vehicle", VehicleDetail],
  ["alarms", AlarmList],
  ["survey", SurveyPanel],
  ["cameras", CamerasPanel],
  ["sun", SunPanel],
  ["zones", ZonesPanel],
  ["site", SitePanel],
  ["vehicles", VehiclesPanel],
  ["calibration", CalibrationPanel],
  ["return", FleetReturn],
  ["orders", CommandList],
  ["timeline", TimelinePanel],
  ["links", LinkList],
  ["photos", PhotosPanel],
  ["flights", FlightsPanel],
  ["station", StationPanel],
];

/** The whole page: the map fills it, and everything else floats over it. */
export function App() {
  const { source, fleet } = useStation();
  const { selection, orderApi } = useOrders();
  const { fit, flyHere, zoneDraft } = useMapModes();
  const { theme, panels } = usePage();
  const { isReplay, clock, behindS } = useStation();
  const { missionDraft } = useMapModes();
  const { siteDraft } = useSiteEditing();
  const { lock, largeCamera } = usePage();
  const [isHelpOpen, setHelpOpen] = createSignal(false);
  const keys = () => fleet.vehicles.map(vehicleKey);
  const select = (key: number, action: (key: number) => void) => {
    if (keys().includes(key)) action(key);
  };

  const numberEntry = createNumberEntry(
    clock,
    (number) => keys().includes(number),
    (number, isAdded) => (isAdded ? selection.toggle(number) : selection.only(number)),
  );

  const sentence = createMemo(() => {
    const state = source.state();
    return state === null ? null : happening(state, behindS());
  });

  const clear = () => {
    if (isHelpOpen()) setHelpOpen(false);
    else {
      const modes = [siteDraft, zoneDraft, missionDraft, flyHere, largeCamera];
      if (!modes.some((mode) => mode.clear())) selection.clear();
    }
  };

  onMount(() => {
    // Before any button: Enter behind a number presses none.
    const onFirst = (event: KeyboardEvent) => {
      const isStop = isAllStop(event);
      const isTaken = !lock.isOn() && numberEntry.take(event);
      if (!isTaken && !isStop) return;
      event.preventDefault();
      event.stopPropagation();
      if (isStop) void orderApi.allStop();
    };
    const onKeyDown = (event: KeyboardEvent) => {
      if (lock.isOn()) return;
      actOnKey(event, {
        selectOnly: (number) => select(number, selection.only),
        toggle: (number) => select(number, selection.toggle),
        selectAll: () => selection.all(keys()),
        clear,
        flyHere: () => !isReplay() && flyHere.toggle(),
        drawMission: () => !isReplay() && missionDraft.toggle(),
        details: () => panels.toggle("vehicle"),
        drawZone: () => !isReplay() && zoneDraft.toggle(),
        undo: () => siteDraft.isOn() && siteDraft.undo(),
        redo: () => siteDraft.isOn() && siteDraft.redo(),
        fit,
        toggleTheme: theme.toggleSun,
        help: () => setHelpOpen(!isHelpOpen()),
      });
    };
    window.addEventListener("keydown", onFirst, { capture: true });
    window.addEventListener("keydown", onKeyDown);
    onCleanup(() => {
      window.removeEventListener("keydown", onFirst, { capture: true });
      window.removeEventListener("keydown", onKeyDown);
    });
  });
  createEffect(() => selection.keep(keys()));
  // The form of a zone being drawn is in its panel.
  createEffect(() => {
    if (zoneDraft.isOn()) panels.open("zones");
  });

  return (
    <div
      class="page"
      classList={{
        "is-lost": source.connection().kind === "lost",
        "is-replay": isReplay(),
        "is-locked": lock.isOn(),
      }}
    >
      <MapView />
      <TopBar onHelp={() => setHelpOpen(!isHelpOpen())} />
      <Show when={sentence()}>{(words) => <p class="card happening wire-text">{words()}</p>}</Show>
      <div class="notices">
        <ConnectionBanner />
        <StopBanner />
        <SilenceBanner />
        <SeparationBanner />
        <AnswerNotice />
        <Show when={numberEntry.number()}>
          {(number) => (
            <p class="card notice" role="status">
              {text.page.enterSelects(number())}
            </p>
          )}
        </Show>
      </div>
      <aside class="dock dock-left" aria-label={text.page.vehicles}>
        <VehicleList />
        <Show when={!isReplay() && !lock.isOn()}>
          <FlyHereCard />
          <MissionCard />
          <OrderBar />
        </Show>
      </aside>
      <aside class="dock dock-right" aria-label={text.page.panels}>
        <For each={PANELS}>
          {([name, panel]) => (
            <Show when={panels.isOpen(name)}>
              <Dynamic component={panel} />
            </Show>
          )}
        </For>
        <Show when={panels.names().length === 0 && !lock.isOn()}>
          <SurveySummary />
        </Show>
      </aside>
      <LargeCamera />
      <TimeScale />
      <ReplayBar />
      <LockScreen />
      <LoginDialog />
      <HelpDialog isOpen={isHelpOpen()} onClose={() => setHelpOpen(false)} />
    </div>
  );
}
