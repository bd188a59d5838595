import { createEffect, createSignal, createUniqueId, type JSX, onCleanup, Show } from "solid-js";

/**
 * A button that opens what it is about beside it; Esc, a press elsewhere or a further press closes
 * it, and so does its content.
 */
export function Popover(props: {
  class: string;
  buttonClass?: string;
  /** Accessible name of the button; without one its content names it. */
  label?: string;
  title?: string;
  button: JSX.Element;
  children: (close: () => void) => JSX.Element;
}) {
  const [isOpen, setOpen] = createSignal(false);
  const id = createUniqueId();
  let whole!: HTMLDivElement;
  let button!: HTMLButtonElement;
  const close = () => {
    setOpen(false);
    button.focus();
  };
  createEffect(() => {
    if (!isOpen()) return;
    const onPress = (event: PointerEvent) => {
      if (event.target instanceof Node && !whole.contains(event.target)) setOpen(false);
    };
    const onKey = (event: KeyboardEvent) => {
      if (event.key !== "Escape") return;
      event.stopPropagation();
      close();
    };
    window.addEventListener("pointerdown", onPress);
    window.addEventListener("keydown", onKey, { capture: true });
    onCleanup(() => {
      window.removeEventListener("pointerdown", onPress);
      window.removeEventListener("keydown", onKey, { capture: true });
    });
  });
  return (
    <div class={props.class} ref={whole}>
      <button
        ref={button}
        type="button"
        class={`button ${props.buttonClass ?? ""}`}
        aria-expanded={isOpen()}
        aria-controls={id}
        aria-label={props.label}
        title={props.title}
        onClick={() => setOpen(!isOpen())}
      >
        {props.button}
      </button>
      <Show when={isOpen()}>
        <div id={id} class="popover">
          {props.children(close)}
        </div>
      </Show>
    </div>
  );
}
