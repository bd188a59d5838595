import { createEffect, For } from "solid-js";
import { text } from "../../text/catalogue";
import "./help.css";

/** Keyboard shortcuts and how orders are confirmed. Not modal: all stop stays in reach. */
export function HelpDialog(props: { isOpen: boolean; onClose: () => void }) {
  let dialog!: HTMLDialogElement;
  let heading!: HTMLHeadingElement;
  createEffect(() => {
    if (props.isOpen && !dialog.open) {
      dialog.show();
      // Else its first control has the focus, and that is at its end.
      heading.focus();
    }
    if (!props.isOpen && dialog.open) dialog.close();
  });
  return (
    <dialog class="help" ref={dialog} aria-label={text.help.name} onClose={() => props.onClose()}>
      <h2 ref={heading} tabindex="-1">
        {text.help.keys}
      </h2>
      <dl class="help-keys">
        <For each={text.help.shortcuts}>
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
      <h2>{text.help.orders}</h2>
      <For each={text.help.ordersText}>{(words) => <p>{words}</p>}</For>
      <h2>{text.help.heights}</h2>
      <p>{text.help.heightsText}</p>
      <button type="button" class="button" onClick={() => props.onClose()}>
        {text.help.close}
      </button>
    </dialog>
  );
}
