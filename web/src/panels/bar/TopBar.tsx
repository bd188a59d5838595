import { createMemo, Show } from "solid-js";
import { useConsole } from "../../console";
import { simulation } from "../../fleet/vehicleStatus";
import { formatAge, formatHeading, formatQuantity } from "../../text/quantities";
import { THEME_NAMES, type Theme } from "../../theme/theme";
import { buttonName } from "../guard/GuardButton";
import { ReplayMark } from "../replay/ReplayBar";
import { AlarmsButton } from "./AlarmsButton";
import { PanelMenu } from "./PanelMenu";
import { StatusButton } from "./StatusButton";
import "./bar.css";

/** The top bar: readiness, site, shadows, alarms, and all stop alone in the right corner. */
export function TopBar(props: { onHelp: () => void }) {
  const { fleet, isReplay } = useConsole();
  const kind = createMemo(() => simulation(fleet.vehicles));
  return (
    <header class="card bar" classList={{ "is-simulation": kind() === "all" }}>
      <h1 class="bar-title">Recon</h1>
      <StatusButton />
      <p class="bar-place">
        <span class="wire-text">{fleet.site?.name ?? ""}</span>
        <Show when={kind() === "all"}>
          <span class="bar-simulation">Simulation</span>
        </Show>
        <Show when={kind() === "mixed"}>
          <strong class="tag tag-simulated">Real and simulated mixed</strong>
        </Show>
      </p>
      <div class="bar-space" />
      <Shadows />
      <AlarmsButton />
      <PanelMenu onHelp={() => props.onHelp()} />
      <ThemeButton />
      <button
        type="button"
        class="button bar-wide"
        onClick={() => props.onHelp()}
        aria-label="Help"
        title="Keys and orders (?)"
      >
        ?
      </button>
      <Show when={isReplay()} fallback={<AllStop />}>
        <ReplayMark />
      </Show>
    </header>
  );
}

/** How the shadows move, by the newest forecast. */
function Shadows() {
  const { fleet } = useConsole();
  const text = () => {
    const { shadows_east_mps: east, shadows_north_mps: north } = fleet.shade?.forecast ?? {};
    if (typeof east !== "number" || typeof north !== "number") return null;
    const from = (Math.atan2(-east, -north) * 180) / Math.PI;
    return `Shadows ${formatQuantity(Math.hypot(east, north), "m/s")} from ${formatHeading(from)}`;
  };
  return <Show when={text()}>{(shown) => <p class="bar-shadows">{shown()}</p>}</Show>;
}

const NEXT: Readonly<Record<Theme, Theme>> = {
  auto: "light",
  light: "dark",
  dark: "sun",
  sun: "light",
};
const SIGNS: Readonly<Record<Theme, string>> = { auto: "◐", light: "☼", dark: "☾", sun: "☀" };

/** The next theme at each press; the menu has them by name. */
function ThemeButton() {
  const { theme } = useConsole();
  const name = () => THEME_NAMES[theme.theme()].toLowerCase();
  return (
    <button
      type="button"
      class="button bar-wide"
      aria-label={`Colours: ${name()}. Change`}
      title={`Colours: ${name()} (T: bright sun)`}
      onClick={() => theme.choose(NEXT[theme.theme()])}
    >
      {SIGNS[theme.theme()]}
    </button>
  );
}

/**
 * Makes all flying vehicles hold position: one press, no confirmation, always in reach. It stays pressed while
 * an all stop is in force; a further press stops again.
 */
export function AllStop() {
  const { orderApi, fleet, behindS } = useConsole();
  const inForce = () => {
    const latch = fleet.stopLatch;
    return latch === null ? null : `in force ${formatAge(latch.age_s + behindS())}`;
  };
  return (
    <button
      type="button"
      class="all-stop"
      classList={{ "is-latched": fleet.stopLatch !== null }}
      aria-label={buttonName("All stop", inForce(), "all flying vehicles hold position")}
      aria-pressed={fleet.stopLatch !== null}
      aria-keyshortcuts="Shift+S"
      title="All flying vehicles hold position. Motors stay on. (Shift+S)"
      onClick={() => void orderApi.allStop()}
    >
      <strong>ALL STOP</strong> <Show when={inForce()}>{(text) => <span>{text()}</span>}</Show>
    </button>
  );
}
