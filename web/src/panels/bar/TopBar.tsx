import { createMemo, Show } from "solid-js";
import { useConsole } from "../../console";
import { simulation } from "../../fleet/vehicleStatus";
import { StateWord } from "./StatusButton";
import "./bar.css";

/** The top of the page: the state word, what flies, and all stop, which keeps the right corner to itself. */
export function TopBar(props: { onHelp: () => void }) {
  const { fleet, theme } = useConsole();
  const flying = () => fleet.vehicles.filter((vehicle) => vehicle.is_flying.value === true).length;
  return (
    <header class="bar">
      <div class="bar-rest">
        <h1 class="bar-title">Recon</h1>
        <StateWord />
        <p class="bar-count">
          <strong>{flying()}</strong> of {fleet.vehicles.length} flying
        </p>
        <SimulationTag />
        <div class="bar-space" />
        <button
          type="button"
          class="button"
          aria-pressed={theme.theme() === "sun"}
          title="High contrast for bright sun (T)"
          onClick={() => theme.toggle()}
        >
          ☀ Sun
        </button>
        <button type="button" class="button" onClick={() => props.onHelp()} aria-label="Help">
          ?
        </button>
      </div>
      <AllStop />
    </header>
  );
}

/** Says when nothing real is flown, and loudly when both are. */
function SimulationTag() {
  const { fleet } = useConsole();
  const kind = createMemo(() => simulation(fleet.vehicles));
  return (
    <Show when={kind() !== "none"}>
      <span class="tag tag-simulated">
        {kind() === "all" ? "SIMULATION" : "REAL AND SIMULATED TOGETHER"}
      </span>
    </Show>
  );
}

/** Makes everything that flies hold its position: one press, no question, in reach at any time. */
export function AllStop() {
  const { desk } = useConsole();
  return (
    <button
      type="button"
      class="all-stop"
      aria-label="All stop: every flying vehicle holds its position"
      aria-keyshortcuts="Shift+S"
      title="Every flying vehicle holds its position. Motors stay on. (Shift+S)"
      onClick={() => void desk.allStop()}
    >
      <strong>ALL STOP</strong>
      <span>hold position</span>
    </button>
  );
}
