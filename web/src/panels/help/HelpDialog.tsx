import { createEffect, For } from "solid-js";
import { SHORTCUTS } from "../../keys";
import "./help.css";

/** What the keys do and how orders are confirmed. Not modal: all stop stays in reach. */
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
          {({ keys, does }) => (
            <div>
              <dt>
                <kbd>{keys}</kbd>
              </dt>
              <dd>{does}</dd>
            </div>
          )}
        </For>
      </dl>
      <h2>Orders</h2>
      <p>
        Hover, return home and land go to the selected vehicles and to no others. Hold the button
        until its bar is full; letting go before, sliding off it, or changing the selection gives no
        order. None of them makes a vehicle take off.
      </p>
      <p>
        Return home first climbs to the aircraft's own go-home height. Return in layers flies each
        vehicle home at a height of its own. Fly here shows what the safety gate says before it is
        confirmed; the target is held for as long as this page is open.
      </p>
      <p>
        ALL STOP needs one press. Everything that flies holds its position; motors stay on. The
        pilot with the sticks always wins.
      </p>
      <button type="button" class="button" onClick={() => props.onClose()}>
        Close
      </button>
    </dialog>
  );
}
