import { For } from "solid-js";
import { useConsole } from "../../console";
import { chooseLengthUnit, LENGTH_UNITS, type LengthUnit, lengthUnit } from "../../text/units";
import { THEME_NAMES, type Theme } from "../../theme/theme";
import { PersonTag } from "../login/PersonTag";
import { PANEL_NAMES, type PanelName } from "../openPanels";
import { Popover } from "../Popover";

const LISTED = (Object.keys(PANEL_NAMES) as PanelName[]).filter((name) => name !== "vehicle");

/** Opens and closes panels; also the colours, the help and the person, for screens without room in the bar. */
export function PanelMenu(props: { onHelp: () => void }) {
  const { panels } = useConsole();
  return (
    <Popover class="menu" label="Menu" title="Panels, colours, help" button="☰">
      {(close) => (
        <section class="card menu-list" aria-label="Menu">
          <For each={LISTED}>
            {(name) => (
              <button
                type="button"
                class="button button-quiet menu-item"
                aria-pressed={panels.isOpen(name)}
                onClick={() => {
                  panels.toggle(name);
                  close();
                }}
              >
                {PANEL_NAMES[name]}
              </button>
            )}
          </For>
          <Colours />
          <Units />
          <button
            type="button"
            class="button button-quiet menu-item"
            onClick={() => {
              close();
              props.onHelp();
            }}
          >
            Keys and orders
          </button>
          <PersonTag />
        </section>
      )}
    </Popover>
  );
}

function Units() {
  return (
    <label class="menu-colours">
      Units
      <select
        class="field"
        value={lengthUnit()}
        onChange={(event) => chooseLengthUnit(event.currentTarget.value as LengthUnit)}
      >
        <For each={Object.entries(LENGTH_UNITS)}>
          {([name, text]) => <option value={name}>{text}</option>}
        </For>
      </select>
    </label>
  );
}

function Colours() {
  const { theme } = useConsole();
  return (
    <label class="menu-colours">
      Colours
      <select
        class="field"
        value={theme.theme()}
        onChange={(event) => theme.choose(event.currentTarget.value as Theme)}
      >
        <For each={Object.entries(THEME_NAMES)}>
          {([name, text]) => <option value={name}>{text}</option>}
        </For>
      </select>
    </label>
  );
}
