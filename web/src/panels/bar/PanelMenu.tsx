import { For, Show } from "solid-js";
import { usePage, useStation } from "../../console";
import { text } from "../../text/catalogue";
import { chooseLengthUnit, LENGTH_UNITS, type LengthUnit, lengthUnit } from "../../text/units";
import type { Theme } from "../../theme/theme";
import { PersonTag } from "../login/PersonTag";
import { PANEL_NAMES } from "../openPanels";
import { Popover } from "../Popover";

const LISTED = PANEL_NAMES.filter((name) => name !== "vehicle");

/** Opens and closes panels; also the colours, the help and the person, for screens without room in the bar. */
export function PanelMenu(props: { onHelp: () => void }) {
  const { isReplay } = useStation();
  const { panels, lock } = usePage();
  return (
    <Popover class="menu" label={text.menu.name} title={text.menu.hint} button="☰">
      {(close) => (
        <section class="card menu-list" aria-label={text.menu.name}>
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
                {text.panels.titles[name]}
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
            {text.menu.help}
          </button>
          <Show when={!isReplay()}>
            <button
              type="button"
              class="button button-quiet menu-item"
              onClick={() => {
                close();
                lock.set(true);
              }}
            >
              {text.lock.lock}
            </button>
          </Show>
          <PersonTag />
        </section>
      )}
    </Popover>
  );
}

function Units() {
  return (
    <label class="menu-colours">
      {text.menu.units}
      <select
        class="field"
        value={lengthUnit()}
        onChange={(event) => chooseLengthUnit(event.currentTarget.value as LengthUnit)}
      >
        <For each={Object.entries(LENGTH_UNITS)}>
          {([unit, name]) => <option value={unit}>{name}</option>}
        </For>
      </select>
    </label>
  );
}

function Colours() {
  const { theme } = usePage();
  return (
    <label class="menu-colours">
      {text.menu.colours}
      <select
        class="field"
        value={theme.theme()}
        onChange={(event) => theme.choose(event.currentTarget.value as Theme)}
      >
        <For each={Object.entries(text.menu.themes)}>
          {([theme, name]) => <option value={theme}>{name}</option>}
        </For>
      </select>
    </label>
  );
}
