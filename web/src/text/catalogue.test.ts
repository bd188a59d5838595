import { describe, expect, it } from "vitest";
import { type WrittenWords, writtenWords } from "../testing/writtenWords";
import { type Catalogue, languageOf } from "./catalogue";

const SOURCES = import.meta.glob<string>(
  ["../**/*.{ts,tsx}", "!../**/*.test.*", "!../**/*.d.ts", "!../testing/**", "!./en/**"],
  { query: "?raw", import: "default", eager: true },
);

/** Shown as they are in every language: the product, and commands for the station's computer. */
const NAMES = /^(?:Recon|recon user add.*)$/;

/** Literals that read like words, and why they are not translated. */
const NO_WORDS: readonly (readonly [why: string, RegExp])[] = [
  [
    "keys of the keyboard",
    /^(?:Escape|Enter|Delete|Shift|Arrow(?:Left|Right|Up|Down)|Key(?:…|[A-Z]))$/,
  ],
  [
    "errors that no operator meets",
    /has no element with id app\.$|^useConsole was called|^A map colour must/,
  ],
  ["types of GeoJSON", /^(?:Feature|FeatureCollection|Point|LineString|Polygon)$/],
  ["HTTP and the DOM", /^(?:Bearer …|Content-Type|TimeoutError)$/],
  [
    "CSS",
    /^(?:\(prefers-color-scheme: dark\)|(?:color-mix|linear-gradient)\(.*|craft-label is-…*)$/,
  ],
  [
    "what a vehicle does and how ready the fleet is: shown by `activity.names` and `readiness.labels`",
    /^(?:Contact lost|Station lost|Unidentified|Landing|Returning|Flying|On the ground|Unknown|Not ready|Warnings|Ready)$/,
  ],
  ["flight modes, as aircraft report them", /^(?:auto landing|confirm landing|go home)$/],
  ["put into sentences of the station, which are English", /^(?:by a newer order|an order)$/],
];

function isException({ words, isShown }: WrittenWords): boolean {
  return NAMES.test(words) || (!isShown && NO_WORDS.some(([, pattern]) => pattern.test(words)));
}

const found = Object.entries(SOURCES).flatMap(([path, source]) =>
  writtenWords(path, source).map((one) => ({ path, ...one })),
);

describe("the console's words", () => {
  it("are in the catalogue, not in the sources", () => {
    const written = found.filter((one) => !isException(one));
    expect(written.map(({ path, line, words }) => `${path}:${line}: ${words}`)).toEqual([]);
  });

  it("have no exception that nothing needs", () => {
    const isNeeded = (pattern: RegExp) => found.some(({ words }) => pattern.test(words));
    expect(Object.keys(SOURCES).length).toBeGreaterThan(150);
    expect(
      [NAMES, ...NO_WORDS.map(([, pattern]) => pattern)].filter((one) => !isNeeded(one)),
    ).toEqual([]);
  });
});

describe("words that are written into a source", () => {
  const EXAMPLE = `
    import { text } from "two words";
    type Kind = "Two words" | "Other";
    const STATES = { running: "Running" };
    const sentence = (count: number) => \`\${count} drones are in the air\`;
    function Example(props: { isOn: boolean; name: string }) {
      if (props.name === "") throw new Error("Type a name.");
      mark.textContent = "holding";
      mark.className = "craft own-colour";
      mark.setAttribute("aria-label", "landing");
      return (
        <section class="card notice" aria-label={props.isOn ? "on" : text.panels.close(props.name)}>
          <button type="button" title={\`remove \${props.name}\`} placeholder="auto">
            {text.alarms.ok} {props.isOn ? "sun" : ""} {props.name === "shade" ? "—" : props.name}
            age
          </button>
        </section>
      );
    }`;

  it("are found: labels, sentences, JSX text, and any word where something is shown", () => {
    const words = writtenWords("Example.tsx", EXAMPLE).map((one) => one.words);
    expect(words).toEqual([
      "Running",
      "… drones are in the air",
      "Type a name.",
      "holding",
      "landing",
      "on",
      "remove …",
      "auto",
      "sun",
      "age",
    ]);
  });

  it("are no exception where they are shown", () => {
    const [one] = writtenWords("Example.tsx", "const shown = <p>Flying</p>;");
    expect(one).toMatchObject({ words: "Flying", isShown: true });
    expect(one && isException(one)).toBe(false);
  });
});

describe("the language of the page", () => {
  it.each([
    [["en-US", "en"], "en"],
    [["xx", "EN-gb"], "en"],
    [["xx-YY"], "en"],
    [[], "en"],
  ] as const)("of a reader of %j is %s", (wanted, language) => {
    expect(languageOf(wanted)).toBe(language);
  });
});

describe("another language", () => {
  it("has its own words and plurals under the same names, checked by the compiler", () => {
    const bar: Pick<Catalogue["bar"], "help" | "alarms"> = {
      help: "Hilfe",
      alarms: (count) => (count === 1 ? "ein Alarm" : `${count} Alarme`),
    };
    expect([bar.alarms(1), bar.alarms(2)]).toEqual(["ein Alarm", "2 Alarme"]);
    // @ts-expect-error: a name is missing
    const incomplete: Pick<Catalogue["bar"], "help" | "alarms"> = { help: "Hilfe" };
    // @ts-expect-error: a state of a link is missing
    const states: Catalogue["links"]["states"] = { waiting: "wartet" };
    // @ts-expect-error: the sentence has other parts
    const hold: Catalogue["guard"]["hold"] = (seconds: number) => `${seconds} s halten`;
    expect([incomplete, states, hold]).toHaveLength(3);
  });
});
