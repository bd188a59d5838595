import { createEffect, onCleanup, Show } from "solid-js";
import { usePage, useStation } from "../../console";
import { text } from "../../text/catalogue";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import "./lock.css";

/** Parts of the page that take neither touches nor keys while it is locked; the shade covers them as well. */
const GUARDED =
  ".map, .map-free, .dock-left, .dock-right > :not(.alarms), .time, .camera-large, .bar .menu, .bar .bar-wide";

/** A locked page: dimmed, and guarded against stray touches. All stop, alarms and notices stay as they are. */
export function LockScreen() {
  const { lock } = usePage();
  return (
    <Show when={lock.isOn()}>
      <Locked />
    </Show>
  );
}

function Locked() {
  const { lock } = usePage();
  let card!: HTMLElement;
  createEffect(() => {
    const guarded = [...document.querySelectorAll<HTMLElement>(GUARDED)];
    for (const one of guarded) one.inert = true;
    card.querySelector("button")?.focus();
    onCleanup(() => {
      for (const one of guarded) one.inert = false;
    });
  });
  return (
    <>
      <div class="lock-shade" />
      <section ref={card} class="card lock" aria-label={text.lock.name}>
        <p>
          <strong>{text.lock.name}.</strong> {text.lock.how}
        </p>
        <GuardButton
          label={text.lock.unlock}
          hold_ms={GUARD_MS}
          needs="observer"
          subject="lock"
          onConfirm={() => lock.set(false)}
        />
      </section>
    </>
  );
}

/** Locks the page. */
export function LockButton() {
  const { isReplay } = useStation();
  const { lock } = usePage();
  return (
    <Show when={!isReplay()}>
      <button
        type="button"
        class="button bar-wide"
        aria-label={text.lock.lock}
        title={text.lock.hint}
        onClick={() => lock.set(true)}
      >
        <svg class="lock-icon" viewBox="0 0 24 24" width="20" height="20" aria-hidden="true">
          <path d="M6 11h12v9H6zM8.5 11V8a3.5 3.5 0 0 1 7 0v3" />
        </svg>
      </button>
    </Show>
  );
}
