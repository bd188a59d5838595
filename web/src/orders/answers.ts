import type { CommandView, OrderResult, Phase, Severity, VehicleView } from "../protocol";
import { text } from "../text/catalogue";
import { commandName, listNames, refusalText } from "../text/names";
import type { OrderAnswer } from "./orderApi";

/** An answer to an order in one line, and the vehicles behind its counts. */
export interface AnswerSummary {
  readonly severity: Severity | null;
  readonly text: string;
  readonly lines: readonly AnswerLine[];
}

/** Vehicles with one result. */
export interface AnswerLine {
  readonly title: string;
  readonly severity: Severity | null;
  readonly names: readonly string[];
}

/**
 * The gate's rule for a vehicle that does not certainly fly. A stop has nothing to do for one on the ground;
 * one of which that is not certain is a refusal, since it may be in the air.
 */
const ON_GROUND_RULE = "flying";
/** What became of an accepted order, as the answer counts it. */
const COUNTED_AS: Readonly<Record<Phase, "reached" | "failed" | "underway">> = {
  queued: "underway",
  sent: "underway",
  acknowledged: "underway",
  confirmed: "reached",
  started: "reached",
  done: "reached",
  refused_by_station: "failed",
  refused_by_app: "failed",
  timed_out: "failed",
  superseded: "underway",
  expired: "failed",
  failed: "failed",
};

/** Orders whose confirmed vehicles are counted by a word: the others are accepted or not. */
const REACHED_WORDS = new Map([
  [text.orders.allStop, text.answers.reached.holding],
  [commandName("hover"), text.answers.reached.holding],
  [commandName("land"), text.answers.reached.landing],
  [commandName("return_home"), text.answers.reached.returning],
]);

/** What became of an order: counts, with what telemetry has confirmed since. */
export function summarise(
  { order, labels, outcome }: OrderAnswer,
  commands: readonly Pick<CommandView, "id" | "phase">[],
  vehicles: readonly VehicleView[],
): AnswerSummary {
  if (outcome.kind === "waiting") {
    const to = labels.length > 3 ? text.answers.drones(labels.length) : listNames(labels);
    return { severity: null, text: text.answers.sent(order, to), lines: [] };
  }
  if (outcome.kind === "failed") {
    return {
      severity: "critical",
      text: text.answers.notConfirmed(order, outcome.problem),
      lines: [],
    };
  }
  const landed = vehicles.filter(
    (one) => one.staleness === "live" && one.is_flying.value === false,
  );
  const onGround = new Set(landed.map(({ serial }) => serial));
  return summariseResults(order, outcome.value, commands, onGround);
}

function summariseResults(
  order: string,
  results: readonly OrderResult[],
  commands: readonly Pick<CommandView, "id" | "phase">[],
  onGround: ReadonlySet<string | null>,
): AnswerSummary {
  const isStop = order === text.orders.allStop;
  const isGrounded = ({ accepted, rule, serial }: OrderResult) =>
    !accepted && isStop && rule === ON_GROUND_RULE && onGround.has(serial);
  const grounded = results.filter(isGrounded);
  const accepted = results.filter((result) => result.accepted);
  const refused = results.filter((result) => !result.accepted && !isGrounded(result));
  if (accepted.length + refused.length === 0) {
    return {
      severity: null,
      text: isStop ? text.answers.stopInForce(order) : text.answers.noneAddressed(order),
      lines: linesOf([[text.answers.onGround, null, grounded]]),
    };
  }
  const phases = new Map(commands.map(({ id, phase }) => [id, phase]));
  const countedAs = (as: "reached" | "failed" | "underway") =>
    accepted.filter(
      ({ command_id }) => COUNTED_AS[phases.get(command_id ?? -1) ?? "queued"] === as,
    );
  const [reached, failed, underway] = [
    countedAs("reached"),
    countedAs("failed"),
    countedAs("underway"),
  ];
  const word = REACHED_WORDS.get(order);
  const total = accepted.length + refused.length;
  const [one] = accepted;
  if (total === 1 && one !== undefined && failed.length === 0 && grounded.length === 0) {
    const state =
      reached.length > 0 ? (word ?? text.answers.confirmedOne) : text.answers.acceptedOne;
    return { severity: null, text: text.answers.one(order, nameWithRemark(one), state), lines: [] };
  }
  const counted = word === undefined ? accepted : reached;
  const problems = [
    ...(failed.length > 0 ? [text.answers.failedCount(failed.length)] : []),
    ...(refused.length > 0 ? [refusedText(refused)] : []),
  ];
  const state = word ?? text.answers.acceptedOne;
  const count = text.answers.counted(order, counted.length, total, state);
  return {
    severity: problems.length > 0 ? "error" : null,
    text: [count, ...problems].join(". "),
    lines: linesOf([
      [text.answers.failed, "error", failed],
      [word === undefined ? text.answers.accepted : text.answers.notYet(word), null, underway],
      [word === undefined ? text.answers.confirmed : word, null, reached],
      [text.answers.onGround, null, grounded],
    ]).concat(
      refused.map((result) => ({
        title: refusalText(result.reason),
        severity: "error",
        names: [nameOf(result)],
      })),
    ),
  };
}

/** One refusal with its reason; more by their number. */
function refusedText(refused: readonly OrderResult[]): string {
  const [only, ...others] = refused;
  if (only === undefined || others.length > 0) return text.answers.refusedCount(refused.length);
  return text.answers.refusedOne(nameOf(only), only.reason ?? text.requests.noReason);
}

function linesOf(
  groups: readonly (readonly [string, Severity | null, readonly OrderResult[]])[],
): AnswerLine[] {
  return groups
    .filter(([, , results]) => results.length > 0)
    .map(([title, severity, results]) => ({ title, severity, names: results.map(nameWithRemark) }));
}

/** A name, with what an accepted order waits for. */
function nameWithRemark(result: OrderResult): string {
  const remark = result.accepted ? result.reason : null;
  return remark === null ? nameOf(result) : `${nameOf(result)} (${remark})`;
}

function nameOf(result: OrderResult): string {
  return result.vehicle_name || text.names.link(result.link_id ?? text.names.unknownLink);
}
