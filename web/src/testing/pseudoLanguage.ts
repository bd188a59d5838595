/**
 * A language to find words that are not in the catalogue: English with every string, and the result of every function,
 * in brackets. The station's words are put into fullwidth letters, so that any plain letter outside the brackets is
 * the console's own and written somewhere else.
 */

const [OPEN, CLOSE] = ["⟦", "⟧"];

/** A catalogue, or a part of one, in brackets. */
export function bracketed<Words>(words: Words): Words {
  return inBrackets(words) as Words;
}

function inBrackets(words: unknown): unknown {
  if (typeof words === "string") return words === "" ? "" : `${OPEN}${words}${CLOSE}`;
  if (typeof words === "function") {
    return (...parts: unknown[]) =>
      inBrackets((words as (...given: unknown[]) => unknown)(...parts));
  }
  if (Array.isArray(words)) return words.map(inBrackets);
  if (!isRoom(words)) return words;
  return Object.fromEntries(Object.entries(words).map(([key, value]) => [key, inBrackets(value)]));
}

/** Puts a language into brackets in place: for whatever is loaded afterwards. */
export function bracketInPlace(language: object): void {
  Object.assign(language, bracketed(language));
}

/** Elements inside a sentence have brackets of their own. */
function isRoom(value: unknown): value is object {
  return typeof value === "object" && value !== null && !(value instanceof Node);
}

const FULLWIDTH = 0xfee0;
/** Values of enumerations, types of GeoJSON, and times, also in the names of records. */
const READ_BY_PAGE = /^[a-z0-9_]*$|^(?:Point|Polygon)$|\d{4}-\d\d-\d\dT|\d{8}T\d/;

/** The station's answers with their names and sentences in fullwidth letters. */
export function foreign<Answer>(answer: Answer): Answer {
  if (typeof answer === "string") return foreignText(answer) as Answer;
  if (Array.isArray(answer)) return answer.map(foreign) as Answer;
  if (typeof answer !== "object" || answer === null) return answer;
  return Object.fromEntries(
    Object.entries(answer).map(([key, value]) => [key, foreign(value)]),
  ) as Answer;
}

function foreignText(words: string): string {
  if (READ_BY_PAGE.test(words)) return words;
  return words.replace(/[A-Za-z]/g, (letter) =>
    String.fromCharCode(letter.charCodeAt(0) + FULLWIDTH),
  );
}

/** Attributes that are read out or shown. */
const SHOWN_ATTRIBUTES = [
  "alt",
  "aria-description",
  "aria-label",
  "aria-valuetext",
  "data-label",
  "placeholder",
  "title",
];

/** The product, commands for the station's computer, and points that the page numbers. */
const NAMES = /\b(?:Recon|recon user add(?: NAME --role ROLE)?|P\d+)\b/g;
const TIMES = /\d{4}-\d\d-\d\dT[\d:.]+Z|\w+-\d{8}T\d+Z|\d+ [A-Z][a-z]{2} \d{4}/g;
const UNITS = /\d[\d.,:]*[\s\u00a0]*(?:m\/s|min|ms|m|ft|s|h|%|ha|px|cm|kB|MB|GB|B)?(?![A-Za-z])/g;
/** In a node of its own, beside its number or name. */
const UNIT_ALONE = /^\s*(?:m|ft)\s*$/;
/** Above takeoff, after a height. */
const DATUM = /[\s\u00a0]ATO\b/g;

/**
 * What is shown below `root` and is neither in brackets nor the station's, with the element that shows it; `known` are
 * further words of the station.
 */
export function unbracketed(root: Element, known: readonly string[]): string[] {
  const shown: (readonly [Element, string])[] = [];
  const nodes = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
  while (nodes.nextNode() !== null) {
    const { parentElement, data } = nodes.currentNode as Text;
    if (parentElement !== null) shown.push([parentElement, data]);
  }
  for (const element of root.querySelectorAll("*"))
    for (const name of SHOWN_ATTRIBUTES) shown.push([element, element.getAttribute(name) ?? ""]);
  const isPlain = (words: string) => {
    const own = known.reduce((rest, one) => rest.replaceAll(one, ""), words);
    return /[A-Za-z]/.test(outsideBrackets(own));
  };
  const found = shown
    .filter(([, words]) => isPlain(words))
    .map(([{ tagName, className }, words]) => `<${tagName} ${String(className)}> ${words.trim()}`);
  return [...new Set(found)];
}

function outsideBrackets(words: string): string {
  let depth = 0;
  let outside = "";
  for (const letter of words) {
    if (letter === CLOSE) depth -= 1;
    if (depth === 0) outside += letter === OPEN ? " " : letter;
    if (letter === OPEN) depth += 1;
  }
  return outside
    .replace(UNIT_ALONE, "")
    .replace(NAMES, "")
    .replace(TIMES, "")
    .replace(UNITS, "")
    .replace(DATUM, "");
}
