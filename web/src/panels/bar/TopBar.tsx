import { createMemo, Show } from "solid-js";
import { useOrders, usePage, useStation } from "../../console";
import { simulation } from "../../fleet/vehicleStatus";
import { text } from "../../text/catalogue";
import { formatAge, formatHeading, formatQuantity } from "../../text/quantities";
import type { Theme } from "../../theme/theme";
import { buttonName } from "../guard/GuardButton";
import { LockButton } from "../lock/LockScreen";
import { ReplayMark } from "../replay/ReplayBar";
import { AlarmsButton } from "./AlarmsButton";
import { PanelMenu } from "./PanelMenu";
import { StatusButton } from "./StatusButton";
import "./bar.css";

/** The top bar: readiness, site, shadows, alarms, and all stop alone in the right corner. */
export function TopBar(props: { onHelp: () => void }) {
  const { fleet, isReplay } = useStation();
  const kind = createMemo(() => simulation(fleet.vehicles));
  return (
    <header class="card bar" classList={{ "is-simulation": kind() === "all" }}>
      <h1 class="bar-title">Recon</h1>
      <StatusButton />
      <p class="bar-place">
        <span class="wire-text">{fleet.site?.name ?? ""}</span>
        <Show when={kind() === "all"}>
          <span class="bar-simulation">{text.bar.simulation}</span>
        </Show>
        <Show when={kind() === "mixed"}>
          <strong class="tag tag-simulated">{text.bar.mixed}</strong>
        </Show>
      </p>
      <div class="bar-space" />
      <Shadows />
      <AlarmsButton />
      <PanelMenu onHelp={() => props.onHelp()} />
      <LockButton />
      <ThemeButton />
      <button
        type="button"
        class="button bar-wide"
        onClick={() => props.onHelp()}
        aria-label={text.bar.help}
        title={text.bar.helpHint}
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
  const { fleet } = useStation();
  const shown = () => {
    const { shadows_east_mps: east, shadows_north_mps: north } = fleet.shade?.forecast ?? {};
    if (typeof east !== "number" || typeof north !== "number") return null;
    const from = (Math.atan2(-east, -north) * 180) / Math.PI;
    return text.bar.shadows(formatQuantity(Math.hypot(east, north), "m/s"), formatHeading(from));
  };
  return <Show when={shown()}>{(words) => <p class="bar-shadows">{words()}</p>}</Show>;
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
  const { theme } = usePage();
  const name = () => text.menu.themes[theme.theme()];
  return (
    <button
      type="button"
      class="button bar-wide"
      aria-label={text.bar.changeColours(name())}
      title={text.bar.coloursHint(name())}
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
  const { fleet, behindS } = useStation();
  const { orderApi } = useOrders();
  const inForce = () => {
    const latch = fleet.stopLatch;
    return latch === null ? null : text.stop.inForceFor(formatAge(latch.age_s + behindS()));
  };
  return (
    <button
      type="button"
      class="all-stop"
      classList={{ "is-latched": fleet.stopLatch !== null }}
      aria-label={buttonName(text.stop.section, inForce(), text.stop.allStopOf)}
      aria-pressed={fleet.stopLatch !== null}
      aria-keyshortcuts="Shift+S"
      title={text.stop.allStopHint}
      onClick={() => void orderApi.allStop()}
    >
      <strong>{text.stop.allStop}</strong>{" "}
      <Show when={inForce()}>{(since) => <span>{since()}</span>}</Show>
    </button>
  );
}
