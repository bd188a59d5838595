import { describe, expect, it } from "vitest";
import { type Catalogue, languageOf } from "./catalogue";

const SOURCES = import.meta.glob<string>(
  ["../**/*.{ts,tsx}", "!../**/*.test.*", "!../**/*.d.ts", "!../testing/**", "!./en/**"],
  { query: "?raw", import: "default", eager: true },
);

/** Comments, imports, types, and the classes of elements. */
const NOT_SHOWN =
  /\/\*[\s\S]*?\*\/|(?<=^|\s)\/\/.*|^(?:im|ex)port\b[^;]*? from .*;$|^(?:export )?type \w+ =[^;]*;|\b\w*[cC]lass\w*(?:=|: | = )(?:"[^"]*"|\{?`.*`)/gm;

const SHOWS =
  "title|alt|label|placeholder|of|text|hint|action|reason|problem|note|stage|checking|fallback|" +
  "textContent|aria-(?:label|description|valuetext|roledescription|placeholder)";

/** Words between tags, and in attributes and properties that are shown or read out. */
const SHOWN: readonly RegExp[] = [
  /(?:(?<!=)>|\})(?!\n\n|,\n|:|, \w+:|\s*(?:as|catch|const|else|finally|return)\b)([^<>{}()[\]"`$=;|&]*\p{L}[^<>{}()[\]"`$=;|&]*)(?:<\/|\{)/gu,
  new RegExp(`(?<![\\w-])(?:${SHOWS})(?:: |=| = )\\{?["\`]([^"\`]*)["\`]`, "g"),
  new RegExp(`setAttribute\\("(?:${SHOWS})", "([^"]*)"`, "g"),
];

/** Any other literal, if it reads as a label (a capitalised word) or as a sentence (two words). */
const LITERAL = /"([^"\n]*)"|`([^`\n]*)`/g;
const READS_AS_WORDS = /^\s*\p{Lu}\p{Ll}|\p{L}{2,}[,.:;]? \p{L}+/u;

/** The catalogue's words joined with others: another language has its own order of words. */
const JOINED = /\$\{text\.[^}]*\}|\btext(?:\.\w+)+(?:\([^()]*\))? \+|\+ text\./g;

/** Literals that read as words, and why they are not translated. */
const NOT_TRANSLATED: readonly (readonly [why: string, RegExp])[] = [
  [
    "the product, and commands for the station's computer",
    /^(?:Recon|recon user add(?: NAME .*)?)$/,
  ],
  ["keys", /^(?:Escape|Enter|Delete|Space|Shift(?:\+.)?|Arrow(?:Left|Right|Up|Down)|Key.)$/],
  [
    "errors that no operator meets",
    /no element with id app\.$|^A shared part was|^A map colour must/,
  ],
  ["types of GeoJSON", /^(?:Feature|FeatureCollection|Point|LineString|Polygon)$/],
  ["HTTP and the DOM", /^(?:Bearer …|Content-Type|TimeoutError)$/],
  [
    "CSS",
    /^(?:\(prefers-color-scheme: dark\)|(?:color-mix|linear-gradient)\(.*|craft-label is-…*)$/,
  ],
  [
    "activities and readiness, shown by `activity.names` and `readiness.labels`",
    /^(?:Contact lost|Station lost|Unidentified|Landing|Returning|Flying|On the ground|Unknown|Not ready|Warnings|Ready)$/,
  ],
  ["flight modes, as aircraft report them", /^(?:auto landing|confirm landing|go home)$/],
  ["put into sentences of the station, which are English", /^(?:by a newer order|an order)$/],
];

/** The words of a source outside the catalogue; `…` stands for what is filled in. */
function writtenWords(source: string): string[] {
  const read = source.replace(NOT_SHOWN, "");
  const shown = SHOWN.flatMap((pattern) => matches(read, pattern)).filter((one) =>
    /\p{L}/u.test(one),
  );
  const others = matches(read, LITERAL).filter((one) => READS_AS_WORDS.test(one));
  return [...new Set([...shown, ...others])];
}

function matches(source: string, pattern: RegExp): string[] {
  return [...source.matchAll(pattern)].map(([, one, other]) =>
    (one ?? other ?? "").replace(/\$\{[^}]*\}/g, "…").trim(),
  );
}

const found = Object.entries(SOURCES).flatMap(([path, source]) =>
  writtenWords(source).map((words) => ({ path, words })),
);

describe("the console's words", () => {
  it("are in the catalogue, not in the sources", () => {
    const isException = (words: string) => NOT_TRANSLATED.some(([, one]) => one.test(words));
    expect(found.filter(({ words }) => !isException(words))).toEqual([]);
  });

  it("are never joined from pieces", () => {
    const joined = Object.entries(SOURCES).flatMap(([path, source]) =>
      (source.match(JOINED) ?? []).map((piece) => `${path}: ${piece}`),
    );
    expect(joined).toEqual([]);
  });

  it("have no exception that nothing needs", () => {
    expect(Object.keys(SOURCES).length).toBeGreaterThan(150);
    const unused = NOT_TRANSLATED.filter(([, one]) => !found.some(({ words }) => one.test(words)));
    expect(unused).toEqual([]);
  });
});

describe("words that are written into a source", () => {
  const EXAMPLE = `
    import { text } from "two words";
    type Kind = "Two words" | "Other";
    const STATES = { running: "Running" };
    const sentence = (count: number) => \`\${count} drones are in the air\`;
    function Example(props: { isOn: boolean; name: string }): Map<string, number> {
      if (props.name === "") throw new Error("Type a name.");
      mark.textContent = "holding";
      mark.className = "craft own-colour";
      mark.setAttribute("aria-label", "landing");
      return (
        <section class="card notice" aria-label={text.panels.close(props.name)}>
          <button type="button" title={\`remove \${props.name}\`} placeholder="auto">
            {text.alarms.ok} {props.name === "shade" ? "—" : props.name}
            age
          </button>
        </section>
      );
    }`.replace(/^ {4}/gm, "");

  it("are found: labels, sentences, and any word where something is shown", () => {
    expect(writtenWords(EXAMPLE).sort()).toEqual([
      "Running",
      "Type a name.",
      "age",
      "auto",
      "holding",
      "landing",
      "remove …",
      "… drones are in the air",
    ]);
  });

  it.each([
    ["`$" + "{text.alarms.ok} $" + "{name}`"],
    ["text.alarms.since(age) + name"],
    ["name + text.alarms.ok"],
  ])("are found when they are joined: %s", (source) => {
    expect(source.match(JOINED)).not.toBeNull();
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
