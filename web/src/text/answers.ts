import type { OrderAnswer } from "../orders/orderApi";
import type { CommandView, OrderResult, Phase, Severity, VehicleView } from "../protocol";
import { listSome, plural } from "./names";

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
const REACHED: readonly Phase[] = ["confirmed", "done", "started"];
const FAILED: readonly Phase[] = [
  "refused_by_station",
  "refused_by_app",
  "timed_out",
  "expired",
  "failed",
];

/** Orders whose confirmed vehicles are counted by a word: the others are accepted or not. */
const REACHED_WORDS: Readonly<Record<string, string>> = {
  "All stop": "holding",
  Hover: "holding",
  Land: "landing",
  "Return home": "returning",
};

/** What became of an order: counts, with what telemetry has confirmed since. */
export function summarise(
  { order, labels, outcome }: OrderAnswer,
  commands: readonly Pick<CommandView, "id" | "phase">[],
  vehicles: readonly VehicleView[],
): AnswerSummary {
  if (outcome.kind === "waiting") {
    const to = labels.length > 3 ? plural(labels.length, "drone") : listSome(labels, 3);
    return { severity: null, text: `${order}: sent to ${to}, waiting for the station`, lines: [] };
  }
  if (outcome.kind === "failed") {
    return { severity: "critical", text: `${order}: not confirmed. ${outcome.problem}`, lines: [] };
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
  const isStop = order === "All stop";
  const isGrounded = ({ accepted, rule, serial }: OrderResult) =>
    !accepted && isStop && rule === ON_GROUND_RULE && onGround.has(serial);
  const grounded = results.filter(isGrounded);
  const accepted = results.filter((result) => result.accepted);
  const refused = results.filter((result) => !result.accepted && !isGrounded(result));
  if (accepted.length + refused.length === 0) {
    const none = isStop ? "in force; no drone is flying" : "no drone was addressed";
    return {
      severity: null,
      text: `${order}: ${none}`,
      lines: linesOf([["On the ground", null, grounded]]),
    };
  }
  const phases = new Map(commands.map(({ id, phase }) => [id, phase]));
  const isIn = ({ command_id }: OrderResult, wanted: readonly Phase[]) =>
    command_id !== null && wanted.includes(phases.get(command_id) ?? "queued");
  const reached = accepted.filter((result) => isIn(result, REACHED));
  const failed = accepted.filter((result) => isIn(result, FAILED));
  const underway = accepted.filter(
    (result) => !reached.includes(result) && !failed.includes(result),
  );
  const word = REACHED_WORDS[order];
  const total = accepted.length + refused.length;
  const [one] = accepted;
  if (total === 1 && one !== undefined && failed.length === 0 && grounded.length === 0) {
    const state = reached.length > 0 ? (word ?? "confirmed") : "accepted";
    return { severity: null, text: `${order} ${nameWithRemark(one)}: ${state}`, lines: [] };
  }
  const counted = word === undefined ? accepted : reached;
  const problems = [
    ...(failed.length > 0 ? [`${failed.length} failed`] : []),
    ...(refused.length > 0 ? [refusedText(refused)] : []),
  ];
  const text = [`${order}: ${counted.length} of ${total} ${word ?? "accepted"}`, ...problems].join(
    ". ",
  );
  return {
    severity: problems.length > 0 ? "error" : null,
    text,
    lines: linesOf([
      ["Failed", "error", failed],
      [word === undefined ? "Accepted" : `Not ${word} yet`, null, underway],
      [word === undefined ? "Confirmed" : word, null, reached],
      ["On the ground", null, grounded],
    ]).concat(
      refused.map((result) => ({
        title: `Refused: ${result.reason ?? "no reason given"}`,
        severity: "error",
        names: [nameOf(result)],
      })),
    ),
  };
}

/** One refusal with its reason; more by their number. */
function refusedText(refused: readonly OrderResult[]): string {
  const [only, ...others] = refused;
  if (only === undefined || others.length > 0) return `${refused.length} refused`;
  return `Refused: ${nameOf(only)}: ${only.reason ?? "no reason given"}`;
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
  return result.vehicle_name || `link ${result.link_id ?? "unknown"}`;
}
