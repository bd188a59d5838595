import { createSignal, Show } from "solid-js";
import { useConsole } from "../../console";
import type { Leader, LeadView } from "../../protocol";
import { formatAge } from "../../words/age";
import { wordProblem } from "../../words/answers";
import { BRIEF_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Problem";
import "./lead.css";

const LEADERS: Readonly<Record<Leader, string>> = {
  pilot: "pilot",
  operator: "operator",
  guidance: "guidance",
};

/** Who leads a vehicle, since when and why; taking it over, and giving it to its pilot. */
export function LeadSection(props: { serial: string; name: string; lead: LeadView }) {
  const { source } = useConsole();
  const [problem, setProblem] = createSignal<string | null>(null);
  const give = async (leader: Leader) => {
    setProblem(wordProblem(await source.takeAuthority(props.serial, leader)));
  };
  const subject = () => JSON.stringify([props.serial, props.lead.leader]);
  return (
    <section class="section" aria-label="Who leads it">
      <LeadText lead={props.lead} />
      <div class="section-buttons">
        <Show when={props.lead.leader !== "operator"}>
          <GuardButton
            label="Take over"
            name={`Take over ${props.name}`}
            hold_ms={BRIEF_MS}
            subject={subject()}
            onConfirm={() => void give("operator")}
          />
        </Show>
        <Show when={props.lead.leader !== "pilot"}>
          <GuardButton
            label="Give to pilot"
            name={`Give ${props.name} to its pilot`}
            hold_ms={BRIEF_MS}
            subject={subject()}
            onConfirm={() => void give("pilot")}
          />
        </Show>
      </div>
      <Problem text={problem()} />
    </section>
  );
}

function LeadText(props: { lead: LeadView }) {
  const { behindS } = useConsole();
  const since = () => {
    const { age_s } = props.lead;
    return age_s === null ? "since the station began" : `for ${formatAge(age_s + behindS())}`;
  };
  return (
    <p class="wire-text">
      Led by <strong class={`lead lead-${props.lead.leader}`}>{LEADERS[props.lead.leader]}</strong>
      <Show when={props.lead.holder !== ""}> ({props.lead.holder})</Show>{" "}
      <span class="muted">
        {since()}
        <Show when={props.lead.reason !== ""}>: {props.lead.reason}</Show>
      </span>
    </p>
  );
}
