import { createSignal, For, Show } from "solid-js";
import { useMapModes, useStation } from "../../console";
import type { ZoneShape } from "../../orders/zoneDraft";
import type { TemporaryZoneView, ZoneKind } from "../../protocol";
import { text } from "../../text/catalogue";
import { personName, responseProblem } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { lengthUnit } from "../../text/units";
import { ZONE_KINDS, zoneEnd, zoneHeights, zoneName } from "../../text/zones";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Empty, Panel, Problem } from "../Panel";
import "./zones.css";

/** Temporary zones: those in force with their end, and the form to draw one. */
export function ZonesPanel() {
  const { fleet } = useStation();
  const { zoneDraft } = useMapModes();
  return (
    <Panel
      title={text.panels.titles.zones}
      name="zones"
      count={fleet.temporaryZones.length}
      actions={
        <button
          type="button"
          class="button"
          title={text.zones.drawHint}
          onClick={() => zoneDraft.toggle()}
        >
          {zoneDraft.isOn() ? text.zones.cancel : text.zones.draw}
        </button>
      }
    >
      <Show when={zoneDraft.isOn()}>
        <DrawForm />
      </Show>
      <Show
        when={fleet.temporaryZones.length > 0}
        fallback={
          <Show when={!zoneDraft.isOn()}>
            <Empty>{text.zones.none}</Empty>
          </Show>
        }
      >
        <ul class="list">
          <For each={fleet.temporaryZones}>{(zone) => <ZoneRow zone={zone} />}</For>
        </ul>
      </Show>
    </Panel>
  );
}

function ZoneRow(props: { zone: TemporaryZoneView }) {
  const { source, behindS } = useStation();
  const [problem, setProblem] = createSignal<string | null>(null);
  const end = async () => setProblem(responseProblem(await source.station.endZone(props.zone.id)));
  return (
    <li class="row" data-testid={`zone-${props.zone.id}`}>
      <div class="row-line">
        <strong>{zoneName(props.zone)}</strong>
        <span>{zoneHeights(props.zone)}</span>
      </div>
      <p class="wire-text">{props.zone.reason}</p>
      <p class="muted wire-text">
        {text.zones.drawn(
          formatAge(props.zone.age_s + behindS()),
          personName(props.zone.by),
          zoneEnd(props.zone.ends_in_s, behindS()),
        )}
      </p>
      <GuardButton
        label={text.zones.end}
        of={text.zones.endOf(zoneName(props.zone))}
        class="guard-grave"
        hold_ms={GUARD_MS}
        subject={String(props.zone.id)}
        onConfirm={() => void end()}
      />
      <Problem text={problem()} />
    </li>
  );
}

/** One press draws the zone: it only brings vehicles to rest, and seconds count. */
function DrawForm() {
  const { source, lacks } = useStation();
  const { zoneDraft, aimAtCentre } = useMapModes();
  const [problem, setProblem] = createSignal<string | null>(null);
  const draw = async () => {
    const zone = zoneDraft.zone();
    if (zone === null) return;
    const refusal = responseProblem(await source.station.drawZone(zone));
    setProblem(refusal);
    if (refusal === null) zoneDraft.leave();
  };
  return (
    <form
      class="section zone-form"
      aria-label={text.zones.form}
      onSubmit={(event) => {
        event.preventDefault();
        void draw();
      }}
    >
      <p class="zone-wide" role="status">
        {hint(zoneDraft.shape(), zoneDraft.points().length)}
      </p>
      <div class="section-buttons zone-wide">
        <button type="button" class="button" onClick={() => aimAtCentre()}>
          {text.zones.useCentre}
        </button>
        <Show when={zoneDraft.shape() === "outline" && zoneDraft.points().length > 0}>
          <button type="button" class="button" onClick={() => zoneDraft.undo()}>
            {text.zones.undoCorner}
          </button>
        </Show>
      </div>
      <label>
        {text.zones.kind}
        <select
          class="field"
          value={zoneDraft.kind()}
          onChange={(event) => zoneDraft.setKind(event.currentTarget.value as ZoneKind)}
        >
          <For each={Object.entries(ZONE_KINDS)}>
            {([kind, { name }]) => <option value={kind}>{name}</option>}
          </For>
        </select>
      </label>
      <label>
        {text.zones.shape}
        <select
          class="field"
          value={zoneDraft.shape()}
          onChange={(event) => zoneDraft.setShape(event.currentTarget.value as ZoneShape)}
        >
          <option value="circle">{text.zones.circle}</option>
          <option value="outline">{text.zones.outline}</option>
        </select>
      </label>
      <Show when={zoneDraft.shape() === "circle"}>
        <label>
          {text.zones.radius(lengthUnit())}
          <input
            class="field"
            type="text"
            inputmode="decimal"
            value={zoneDraft.radius.text()}
            onInput={(event) => zoneDraft.radius.type(event.currentTarget.value)}
          />
        </label>
      </Show>
      <label>
        {text.zones.minutes}
        <input
          class="field"
          type="text"
          inputmode="decimal"
          value={zoneDraft.minutes()}
          onInput={(event) => zoneDraft.setMinutes(event.currentTarget.value)}
        />
      </label>
      <label class="zone-wide">
        {text.zones.reason}
        <input
          class="field"
          type="text"
          maxlength={200}
          placeholder={ZONE_KINDS[zoneDraft.kind()].reason}
          value={zoneDraft.reason()}
          onInput={(event) => zoneDraft.setReason(event.currentTarget.value)}
        />
      </label>
      <button
        type="submit"
        class="button zone-go zone-wide"
        disabled={zoneDraft.zone() === null || lacks("pilot") !== null}
        title={lacks("pilot") ?? undefined}
      >
        {text.zones.go}
      </button>
      <Problem text={problem()} />
    </form>
  );
}

function hint(shape: ZoneShape, points: number): string {
  if (shape === "circle") {
    return points === 0 ? text.zones.pressCentre : text.zones.moveCentre;
  }
  const left = 3 - points;
  if (left > 0) return text.zones.pressCorners(left);
  return text.zones.corners(points);
}
