import { createEffect, For } from "solid-js";
import { SHORTCUTS } from "../../keys";
import "./help.css";

/** Keyboard shortcuts and how orders are confirmed. Not modal: all stop stays in reach. */
export function HelpDialog(props: { isOpen: boolean; onClose: () => void }) {
  let dialog!: HTMLDialogElement;
  createEffect(() => {
    if (props.isOpen && !dialog.open) dialog.show();
    if (!props.isOpen && dialog.open) dialog.close();
  });
  return (
    <dialog class="help" ref={dialog} aria-label="Help" onClose={() => props.onClose()}>
      <h2>Keys</h2>
      <dl class="help-keys">
        <For each={SHORTCUTS}>
          {({ keys, action }) => (
            <div>
              <dt>
                <kbd>{keys}</kbd>
              </dt>
              <dd>{action}</dd>
            </div>
          )}
        </For>
      </dl>
      <h2>Orders</h2>
      <p>
        Hover, return home and land are sent to the selected vehicles only. Hover takes one press.
        Hold the others until the bar is full; releasing early, sliding off or changing the
        selection cancels the order. None of these orders makes a vehicle take off.
      </p>
      <p>
        Return home climbs to the aircraft's go-home height first. Return in layers flies each
        vehicle home at a separate height. Fly here shows the safety gate's result before you
        confirm; the vehicle holds the target while this page stays open and stops if it closes.
      </p>
      <p>
        ALL STOP takes one press. All flying vehicles hold position; motors stay on. It stays in
        force: only hover, return and land are sent until the vehicles are released. The pilot's
        sticks always override the station.
      </p>
      <h2>Heights</h2>
      <p>
        ATO is above the vehicle's own takeoff point. Other heights name their datum in full. The
        menu has metres or feet for heights and distances; sentences of the station and the site's
        editor are in metres.
      </p>
      <button type="button" class="button" onClick={() => props.onClose()}>
        Close
      </button>
    </dialog>
  );
}
