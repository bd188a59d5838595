import { createSignal, Show } from "solid-js";
import { useConsole } from "../../console";
import type { AuthorityHolder, AuthorityView } from "../../protocol";
import { wordProblem } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { BRIEF_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Panel";
import "./authority.css";

const HOLDERS: Readonly<Record<AuthorityHolder, string>> = {
  pilot: "pilot",
  operator: "operator",
  guidance: "guidance",
};

/** Who leads a vehicle, since when and why; taking it over, and giving it to its pilot. */
export function AuthoritySection(props: {
  serial: string;
  name: string;
  authority: AuthorityView;
}) {
  const { source } = useConsole();
  const [problem, setProblem] = createSignal<string | null>(null);
  const give = async (holder: AuthorityHolder) => {
    setProblem(wordProblem(await source.takeAuthority(props.serial, holder)));
  };
  const subject = () => JSON.stringify([props.serial, props.authority.holder]);
  return (
    <section class="section" aria-label="Who leads it">
      <AuthorityText authority={props.authority} />
      <div class="section-buttons">
        <Show when={props.authority.holder !== "operator"}>
          <GuardButton
            label="Take over"
            name={`Take over ${props.name}`}
            hold_ms={BRIEF_MS}
            subject={subject()}
            onConfirm={() => void give("operator")}
          />
        </Show>
        <Show when={props.authority.holder !== "pilot"}>
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

function AuthorityText(props: { authority: AuthorityView }) {
  const { behindS } = useConsole();
  const since = () => {
    const { age_s } = props.authority;
    return age_s === null ? "since the station began" : `for ${formatAge(age_s + behindS())}`;
  };
  return (
    <p class="wire-text">
      Controlled by{" "}
      <strong class={`authority authority-${props.authority.holder}`}>
        {HOLDERS[props.authority.holder]}
      </strong>
      <Show when={props.authority.holder_name !== ""}> ({props.authority.holder_name})</Show>{" "}
      <span class="muted">
        {since()}
        <Show when={props.authority.reason !== ""}>: {props.authority.reason}</Show>
      </span>
    </p>
  );
}
