import { createEffect, createMemo, createSignal, For, onCleanup, onMount, Show } from "solid-js";
import { useStation } from "../../console";
import { isAlarmNow } from "../../fleet/alarmGroups";
import type { ReplayMark as Mark, ReplayTransport, ReplayView } from "../../protocol";
import { titleOf } from "../../sound/attention";
import { text } from "../../text/catalogue";
import { formatDay, formatPosition, formatTimeOfDay } from "../../text/replay";
import { Problem } from "../Panel";
import "./replay.css";

export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20, 50] as const;
const MARKS_AGAIN_MS = 2_000;
/** How long the next state may take to show where a seek went. */
const SETTLES_MS = 300;
/** Of the marks over the length of the slider. */
const SCALE = 1000;

/** In place of all stop: nothing on this page flies. */
export function ReplayMark() {
  return (
    <strong class="replay-mark" title={text.replay.markHint}>
      {text.replay.mark}
    </strong>
  );
}

/** The transport of a replay; nothing on a live station. */
export function ReplayBar() {
  const { isReplay, replay, fleet } = useStation();
  const fresh = () =>
    fleet.alarms.filter((alarm) => isAlarmNow(alarm) && !alarm.is_acknowledged).length;
  createEffect(() => {
    document.title = isReplay() ? text.page.replayTitle(text.page.product) : titleOf(fresh());
  });
  return <Show when={isReplay() && replay()}>{(view) => <Transport view={view()} />}</Show>;
}

function StepButton(props: {
  name: string;
  icon: string;
  mark: Mark | null;
  onPress: (mark: Mark) => void;
}) {
  return (
    <button
      type="button"
      class="button button-quiet"
      aria-label={props.name}
      title={props.name}
      disabled={props.mark === null}
      onClick={() => props.mark !== null && props.onPress(props.mark)}
    >
      <span aria-hidden="true">{props.icon}</span>
    </button>
  );
}

function Transport(props: { view: ReplayView }) {
  const { source, clock } = useStation();
  const [problem, setProblem] = createSignal<string | null>(null);
  const [sought, setSought] = createSignal<number | null>(null);
  const marks = createMarks();
  const position = () => sought() ?? props.view.position_s;
  const duration = () => props.view.duration_s;
  const unixMs = (at_s: number) =>
    (source.state()?.time_ns ?? 0) / 1e6 + 1000 * (at_s - props.view.position_s);

  const change = async (transport: ReplayTransport) => {
    const outcome = await source.replay.change(transport);
    setProblem(outcome.kind === "failed" ? outcome.problem : null);
  };
  // While a drag goes on, one request at a time: the newest place is sent next.
  let isSeeking = false;
  const seek = async (at_s: number) => {
    setSought(Math.min(duration(), Math.max(0, at_s)));
    if (isSeeking) return;
    isSeeking = true;
    let asked: number | null = null;
    while (asked !== sought()) {
      asked = sought();
      await change({ position_s: asked });
    }
    isSeeking = false;
    const settled = asked;
    clock.after(SETTLES_MS, () => {
      if (sought() === settled && !isSeeking) setSought(null);
    });
  };
  let slider!: HTMLInputElement;
  // Space does nothing on a slider: it keeps the focus after a press, and Space still plays.
  const hasOwnUse = (target: EventTarget | null) =>
    target !== document.body && target !== slider && !(target instanceof HTMLCanvasElement);
  const togglePlay = () => void change({ is_playing: !props.view.is_playing });
  onMount(() => {
    const onKey = (event: KeyboardEvent) => {
      if (event.key !== " " || event.repeat || hasOwnUse(event.target)) return;
      event.preventDefault();
      togglePlay();
    };
    window.addEventListener("keydown", onKey);
    onCleanup(() => window.removeEventListener("keydown", onKey));
  });
  const current = createMemo(() => markAt(marks(), position()));
  const next = () => marks().find(({ at_s }) => at_s > position() + 0.5) ?? null;
  const previous = () => marks().findLast(({ at_s }) => at_s < position() - 0.5) ?? null;
  const toMark = (mark: Mark) => void seek(mark.at_s);
  return (
    <section class="card replay" aria-label={text.replay.name}>
      <div class="replay-row">
        <strong class="replay-word">{text.replay.mark}</strong>
        <button
          type="button"
          class="button replay-play"
          aria-label={props.view.is_playing ? text.replay.pause : text.replay.play}
          aria-keyshortcuts="Space"
          title={props.view.is_playing ? text.replay.pauseHint : text.replay.playHint}
          onClick={togglePlay}
        >
          <span aria-hidden="true">{props.view.is_playing ? "❚❚" : "▶"}</span>
        </button>
        <label class="replay-speed">
          <span class="replay-wide">{text.replay.speed}</span>
          <select
            aria-label={text.replay.speedName}
            onChange={(event) => void change({ speed: Number(event.currentTarget.value) })}
          >
            <For each={SPEEDS}>
              {(speed) => (
                <option value={speed} selected={speed === props.view.speed}>
                  {speed}×
                </option>
              )}
            </For>
          </select>
        </label>
        <StepButton name={text.replay.previous} icon="|◂" mark={previous()} onPress={toMark} />
        <StepButton name={text.replay.next} icon="▸|" mark={next()} onPress={toMark} />
        <p class="replay-mark-text wire-text muted" aria-live="polite">
          {current()?.text ?? props.view.file}
        </p>
        <p class="replay-time">
          <span class="replay-wide muted">{formatDay(unixMs(position()))}</span>{" "}
          <strong title={text.replay.localTime}>{formatTimeOfDay(unixMs(position()))}</strong>{" "}
          <span class="replay-position muted" data-testid="replay-position">
            {formatPosition(position())} / {formatPosition(duration())}
          </span>
        </p>
      </div>
      <div class="replay-scale">
        <MarkLines marks={marks()} duration_s={duration()} />
        <input
          ref={slider}
          type="range"
          min={0}
          max={duration()}
          step={Math.min(1, duration() / 100) || 1}
          value={position()}
          aria-label={text.replay.position}
          aria-valuetext={text.replay.positionOf(
            formatPosition(position()),
            formatPosition(duration()),
            formatTimeOfDay(unixMs(position())),
          )}
          onInput={(event) => void seek(Number(event.currentTarget.value))}
        />
      </div>
      <Show when={props.view.trouble}>
        {(trouble) => <p class="tone-warning wire-text">{text.replay.endsEarly(trouble())}</p>}
      </Show>
      <Problem text={problem()} />
    </section>
  );
}

/** Alarms stand above the scale's middle, orders below: never colour alone. */
function MarkLines(props: { marks: readonly Mark[]; duration_s: number }) {
  const path = (kind: Mark["kind"], from: number, to: number) =>
    props.marks
      .filter((mark) => mark.kind === kind)
      .map(({ at_s }) => Math.round((SCALE * at_s) / Math.max(props.duration_s, 1e-9)))
      .filter((at, index, all) => all.indexOf(at) === index)
      .map((at) => `M${at} ${from}V${to}`)
      .join("");
  return (
    <svg
      class="replay-marks"
      viewBox={`0 0 ${SCALE} 24`}
      preserveAspectRatio="none"
      aria-hidden="true"
    >
      <path class="replay-alarms" d={path("alarm", 0, 12)} />
      <path class="replay-orders" d={path("order", 12, 24)} />
    </svg>
  );
}

/** The newest mark up to a position, if it is of the last seconds. */
export function markAt(marks: readonly Mark[], at_s: number): Mark | null {
  const mark = marks.findLast((each) => each.at_s <= at_s + 0.05);
  return mark !== undefined && at_s - mark.at_s < 10 ? mark : null;
}

/** The record's marks; asked for again until the whole record was read. */
function createMarks() {
  const { source, clock } = useStation();
  const [marks, setMarks] = createSignal<readonly Mark[]>([]);
  let isGone = false;
  const read = async () => {
    const outcome = await source.replay.marks();
    if (isGone) return;
    if (outcome.kind === "answered") setMarks(outcome.value.marks);
    if (outcome.kind === "failed" || outcome.value.read_share < 1) {
      clock.after(MARKS_AGAIN_MS, () => !isGone && void read());
    }
  };
  void read();
  onCleanup(() => {
    isGone = true;
  });
  return createMemo(marks);
}
