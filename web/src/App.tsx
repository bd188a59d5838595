import { createEffect, createSignal, onCleanup, onMount } from "solid-js";
import { useConsole } from "./console";
import { vehicleKey } from "./fleet/vehicleStatus";
import { actOnKey } from "./keys";
import { MapView } from "./map/MapView";
import { AlarmList } from "./panels/alarms/AlarmList";
import { ConnectionBanner } from "./panels/bar/ConnectionBanner";
import { TopBar } from "./panels/bar/TopBar";
import { CommandList } from "./panels/commands/CommandList";
import { VehicleDetail } from "./panels/detail/VehicleDetail";
import { FlyHereCard } from "./panels/fly/FlyHereCard";
import { HelpDialog } from "./panels/help/HelpDialog";
import { LinkList } from "./panels/links/LinkList";
import { LoginDialog } from "./panels/login/LoginDialog";
import { OrderBar } from "./panels/orders/OrderBar";
import { FleetReturn } from "./panels/return/FleetReturn";
import { SeparationBanner } from "./panels/separation/SeparationHold";
import { StationPanel } from "./panels/station/StationPanel";
import { StopBanner } from "./panels/stop/StopLatch";
import { SunPanel } from "./panels/sun/SunPanel";
import { SurveyPanel } from "./panels/survey/SurveyPanel";
import { VehicleList } from "./panels/vehicles/VehicleList";
import { ZonesPanel } from "./panels/zones/ZonesPanel";
import "./layout.css";

/** The whole page. */
export function App() {
  const { source, fleet, selection, orderApi, theme, fit, flyHere, zoneDraft } = useConsole();
  const [isHelpOpen, setHelpOpen] = createSignal(false);
  const keys = () => fleet.vehicles.map(vehicleKey);
  const select = (key: number, action: (key: number) => void) => {
    if (keys().includes(key)) action(key);
  };

  const clear = () => {
    if (isHelpOpen()) setHelpOpen(false);
    else if (!zoneDraft.clear() && !flyHere.clear()) selection.clear();
  };

  onMount(() => {
    const onKeyDown = (event: KeyboardEvent) => {
      actOnKey(event, {
        allStop: () => void orderApi.allStop(),
        selectOnly: (number) => select(number, selection.only),
        toggle: (number) => select(number, selection.toggle),
        selectAll: () => selection.all(keys()),
        clear,
        flyHere: flyHere.toggle,
        drawZone: zoneDraft.toggle,
        fit,
        toggleTheme: theme.toggle,
        help: () => setHelpOpen(!isHelpOpen()),
      });
    };
    window.addEventListener("keydown", onKeyDown);
    onCleanup(() => window.removeEventListener("keydown", onKeyDown));
  });
  createEffect(() => selection.keep(keys()));

  return (
    <div class="page" classList={{ "is-lost": source.connection().kind === "lost" }}>
      <TopBar onHelp={() => setHelpOpen(!isHelpOpen())} />
      <div class="banners">
        <ConnectionBanner />
        <StopBanner />
        <SeparationBanner />
      </div>
      <aside class="side side-vehicles" aria-label="Vehicles">
        <VehicleList />
        <VehicleDetail />
      </aside>
      <MapView />
      <FlyHereCard />
      <OrderBar />
      <aside class="side side-events" aria-label="Alarms and commands">
        <AlarmList />
        <ZonesPanel />
        <SurveyPanel />
        <SunPanel />
        <FleetReturn />
        <CommandList />
        <LinkList />
        <StationPanel />
      </aside>
      <LoginDialog />
      <HelpDialog isOpen={isHelpOpen()} onClose={() => setHelpOpen(false)} />
    </div>
  );
}
