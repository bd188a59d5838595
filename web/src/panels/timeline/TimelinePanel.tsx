import { createEffect, createSignal, For, on, onCleanup, Show } from "solid-js";
import { useStation } from "../../console";
import type { TimelineEntryView, TimelineSubject } from "../../protocol";
import { valuesOf } from "../../protocol/values";
import { text } from "../../text/catalogue";
import { capitalised, personName, vehicleLabel, withoutNumbers } from "../../text/names";
import { Empty, Panel, Problem } from "../Panel";
import "./timeline.css";

const EVERY_MS = 2_000;
const PAGE = 50;
/** Lines kept: the panel may be open for a day. */
const MOST = 500;
const ALL = "";

const SUBJECTS = valuesOf(text.timeline.subjects);

/** What happened in this run, the newest first: of all drones or one, by subject. */
export function TimelinePanel() {
  const { source, clock, fleet } = useStation();
  const [serial, setSerial] = createSignal<string | null>(null);
  const [about, setAbout] = createSignal<TimelineSubject | null>(null);
  /** Null before the first answer. */
  const [entries, setEntries] = createSignal<readonly TimelineEntryView[] | null>(null);
  const [hasMore, setMore] = createSignal(false);
  const [problem, setProblem] = createSignal<string | null>(null);
  let question = 0;
  let cancel = () => {};

  const shown = () => entries() ?? [];
  const show = (next: readonly TimelineEntryView[]) => {
    setEntries(next.slice(0, MOST));
    if (next.length > MOST) setMore(true);
  };
  /** Joins the newest to those shown; with `before`, adds those before that number. */
  const load = async (before: number | null) => {
    const asked = question;
    const outcome = await source.station.timeline(
      { serial: serial(), about: about(), before },
      before === null ? PAGE : 2 * PAGE,
    );
    if (asked !== question) return;
    setProblem(outcome.kind === "failed" ? outcome.problem : null);
    if (outcome.kind === "failed") return;
    const found = outcome.value.entries;
    if (before !== null) {
      // They were added already, or the newest have started over.
      if (shown().at(-1)?.n !== before) return;
      setMore(outcome.value.has_more);
      show([...shown(), ...found]);
      return;
    }
    const last = found.at(-1)?.n ?? 0;
    const older = shown().filter(({ n }) => n < last);
    // A gap means that more came than one page holds: what is older is asked for again.
    const isJoined = shown().some(({ n }) => n >= last);
    if (!isJoined || older.length === 0) setMore(outcome.value.has_more);
    show(isJoined ? [...found, ...older] : found);
  };
  const follow = async () => {
    const asked = question;
    await load(null);
    if (asked === question) cancel = clock.after(EVERY_MS, () => void follow());
  };
  createEffect(
    on([serial, about], () => {
      question += 1;
      cancel();
      setEntries(null);
      setProblem(null);
      void follow();
    }),
  );
  onCleanup(() => {
    question += 1;
    cancel();
  });

  return (
    <Panel title={text.panels.titles.timeline} name="timeline">
      <div class="section timeline-filters">
        <label>
          {text.timeline.drone}
          <select
            class="field"
            value={serial() ?? ALL}
            onChange={(event) => setSerial(event.currentTarget.value || null)}
          >
            <option value={ALL}>{text.timeline.allDrones}</option>
            <For each={fleet.vehicles.filter((one) => one.serial !== null)}>
              {(vehicle) => <option value={vehicle.serial ?? ALL}>{vehicleLabel(vehicle)}</option>}
            </For>
          </select>
        </label>
        <label>
          {text.timeline.about}
          <select
            class="field"
            value={about() ?? ALL}
            onChange={(event) =>
              setAbout((event.currentTarget.value || null) as TimelineSubject | null)
            }
          >
            <option value={ALL}>{text.timeline.everything}</option>
            <For each={SUBJECTS}>
              {(subject) => <option value={subject}>{text.timeline.subjects[subject]}</option>}
            </For>
          </select>
        </label>
      </div>
      <Problem text={problem()} />
      <Show
        when={shown().length > 0}
        fallback={
          <Show when={problem() === null}>
            <Empty>{entries() === null ? text.timeline.loading : text.timeline.empty}</Empty>
          </Show>
        }
      >
        {/* Scrollable lists are reached by keyboard too. */}
        {/* biome-ignore lint/a11y/noNoninteractiveTabindex: it scrolls */}
        <ol class="timeline" tabIndex={0} aria-label={text.timeline.name}>
          <For each={shown()}>{(entry) => <Line entry={entry} />}</For>
        </ol>
        <Show when={hasMore()}>
          <div class="section">
            <Show
              when={shown().length < MOST}
              fallback={<p class="muted">{text.timeline.onlyNewest(MOST)}</p>}
            >
              <button
                type="button"
                class="button"
                onClick={() => void load(shown().at(-1)?.n ?? null)}
              >
                {text.timeline.earlier}
              </button>
            </Show>
          </div>
        </Show>
      </Show>
    </Panel>
  );
}

function Line(props: { entry: TimelineEntryView }) {
  return (
    <li class={`timeline-line timeline-${props.entry.kind.split(".")[0]}`}>
      <time dateTime={props.entry.utc} title={props.entry.utc}>
        {clockTime(props.entry.utc)}
      </time>
      <span class="wire-text">
        {capitalised(withoutNumbers(props.entry.text))}
        <Show when={props.entry.by !== "station"}>
          <span class="muted"> {capitalised(personName(props.entry.by))}</span>
        </Show>
      </span>
    </li>
  );
}

/** The time of day here, to the second. */
export function clockTime(utc: string): string {
  const date = new Date(utc);
  if (Number.isNaN(date.getTime())) return utc;
  const part = (value: number) => String(value).padStart(2, "0");
  return [date.getHours(), date.getMinutes(), date.getSeconds()].map(part).join(":");
}
