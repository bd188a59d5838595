import { useStation } from "../../console";
import type { FleetView } from "../../fleet/fleetView";
import { simulation } from "../../fleet/vehicleStatus";
import type { Outcome, SurveyResponse } from "../../protocol";
import { text } from "../../text/catalogue";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";

/** How a rehearsal is flown: as the survey form is first filled in, at a speed that its overlap allows. */
const FLOWN = { height_above_takeoff_m: 50, speed_mps: 5, side_step_allowed: true };

/** Whether all drones are simulated, and no script flies them. */
export function isRehearsal(fleet: Pick<FleetView, "station" | "vehicles">): boolean {
  return fleet.station?.repeats_surveys !== true && simulation(fleet.vehicles) === "all";
}

/** One button that plans a survey of a region, and starts it with all simulated drones: the hold allows takeoff. */
export function Rehearse(props: {
  region: string;
  onResult: (outcome: Outcome<SurveyResponse>) => void;
}) {
  const { fleet, source } = useStation();
  const serials = () =>
    fleet.vehicles.flatMap(({ serial, is_imager }) =>
      serial === null || is_imager ? [] : [serial],
    );
  const rehearse = async () => {
    // The props of a form that is gone once there is a survey.
    const { onResult } = props;
    const flown = serials();
    const planned = await source.surveys.plan({ ...FLOWN, region: props.region });
    onResult(planned);
    const survey = planned.kind === "answered" && planned.value.accepted && planned.value.survey;
    if (survey) onResult(await source.surveys.start(survey.id, flown, true));
  };
  return (
    <section class="section" aria-label={text.rehearsal.title}>
      <p class="wire-text">{text.rehearsal.what(serials().length, props.region)}</p>
      <GuardButton
        label={text.rehearsal.start}
        of={text.rehearsal.of(props.region)}
        class="rehearse"
        hold_ms={GUARD_MS}
        subject={serials().join(" ")}
        onConfirm={() => void rehearse()}
      />
    </section>
  );
}
