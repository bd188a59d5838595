/** Runs an action before the next frame. */
export type NextFrame = (action: () => void) => void;

/** After so long without a frame the page goes on: it may be hidden, or the screen hangs. */
const LONGEST_FRAME_MS = 250;

/** The browser's frames; at once while the page is hidden, when it draws none. */
export const browserFrame: NextFrame = (action) => {
  if (document.hidden) {
    action();
    return;
  }
  let isDone = false;
  const once = () => {
    if (!isDone) action();
    isDone = true;
  };
  requestAnimationFrame(once);
  setTimeout(once, LONGEST_FRAME_MS);
};

/**
 * Hands on values no faster than the screen shows them, the newest one always. A frame that is asked for while earlier
 * ones wait to be drawn waits behind all of them: without a GPU 64 vehicles were shown four states late.
 */
export class FramePacer<T> {
  private waiting: { readonly value: T } | null = null;
  private isDrawing = false;

  constructor(
    private readonly show: (value: T) => void,
    private readonly nextFrame: NextFrame,
  ) {}

  offer(value: T): void {
    if (this.isDrawing) this.waiting = { value };
    else this.hand(value);
  }

  /** Shows a value at once, and forgets those that wait. */
  restart(value: T): void {
    this.waiting = null;
    this.show(value);
  }

  private hand(value: T): void {
    this.isDrawing = true;
    try {
      this.show(value);
    } finally {
      // The frame with this value is drawn after the first callback, and handed to the screen before the second.
      this.nextFrame(() => this.nextFrame(() => this.release()));
    }
  }

  private release(): void {
    this.isDrawing = false;
    const { waiting } = this;
    this.waiting = null;
    if (waiting !== null) this.hand(waiting.value);
  }
}
