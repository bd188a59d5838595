import type { WordResponse } from "../protocol";
import type { Outcome } from "../source/stationSource";
import { plainWords } from "./names";

/** A refusal as it is read everywhere: the rule by name, then its sentence. */
export function refusalText(rule: string | null, reason: string | null): string {
  const name = rule === null || rule === "" ? "no rule given" : plainWords(rule);
  return `Refused (${name}): ${reason ?? "no reason given"}`;
}

/** Why a word to the station was not taken; null when it was. */
export function wordProblem(outcome: Outcome<WordResponse | null>): string | null {
  if (outcome.kind === "failed") return outcome.problem;
  const word = outcome.value;
  return word === null || word.accepted ? null : refusalText(word.rule, word.reason);
}
