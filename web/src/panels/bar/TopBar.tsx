import { createMemo, Show } from "solid-js";
import { useConsole } from "../../console";
import { simulation } from "../../fleet/vehicleStatus";
import { PersonTag } from "../login/PersonTag";
import { StatusButton } from "./StatusButton";
import "./bar.css";

/** The top bar: readiness, number of flying vehicles, and all stop alone in the right corner. */
export function TopBar(props: { onHelp: () => void }) {
  const { fleet, theme } = useConsole();
  const flying = () => fleet.vehicles.filter((vehicle) => vehicle.is_flying.value === true).length;
  return (
    <header class="bar">
      <div class="bar-rest">
        <h1 class="bar-title">Recon</h1>
        <StatusButton />
        <p class="bar-count">
          <strong>{flying()}</strong> of {fleet.vehicles.length} flying
        </p>
        <SimulationTag />
        <div class="bar-space" />
        <PersonTag />
        <button
          type="button"
          class="button"
          aria-pressed={theme.theme() === "sun"}
          title="High contrast for bright sun (T)"
          onClick={() => theme.toggle()}
        >
          ☀ Contrast
        </button>
        <button type="button" class="button" onClick={() => props.onHelp()} aria-label="Help">
          ?
        </button>
      </div>
      <AllStop />
    </header>
  );
}

/** Marks a simulation, and a dangerous mix of real and simulated vehicles. */
function SimulationTag() {
  const { fleet } = useConsole();
  const kind = createMemo(() => simulation(fleet.vehicles));
  return (
    <Show when={kind() !== "none"}>
      <span class="tag tag-simulated">
        {kind() === "all" ? "SIMULATION" : "REAL AND SIMULATED MIXED"}
      </span>
    </Show>
  );
}

/** Makes all flying vehicles hold position: one press, no confirmation, always in reach. */
export function AllStop() {
  const { orderApi } = useConsole();
  return (
    <button
      type="button"
      class="all-stop"
      aria-label="All stop: all flying vehicles hold position"
      aria-keyshortcuts="Shift+S"
      title="All flying vehicles hold position. Motors stay on. (Shift+S)"
      onClick={() => void orderApi.allStop()}
    >
      <strong>ALL STOP</strong>
      <span>hold position</span>
    </button>
  );
}
