import { english } from "./en";

/**
 * The console's own words, each language in a folder of its own. The station's sentences (alarms, refusals, reasons)
 * are shown as they come.
 */

/** What every language has: the same names, with words or with sentences of the same parts. */
type Words<English> = English extends (...parts: infer Parts) => infer Sentence
  ? (...parts: Parts) => [Sentence] extends [string] ? string : Sentence
  : English extends string
    ? string
    : { readonly [Key in keyof English]: Words<English[Key]> };

export type Catalogue = Words<typeof english>;

const CATALOGUES = { en: english } as const satisfies Readonly<Record<string, Catalogue>>;

export type Language = keyof typeof CATALOGUES;

/** The first of the reader's languages that there is a catalogue of; else English. */
export function languageOf(wanted: readonly string[]): Language {
  const known = Object.keys(CATALOGUES) as readonly Language[];
  const primary = wanted.map((tag) => tag.toLowerCase().split("-")[0]);
  return primary.flatMap((one) => known.find((language) => language === one) ?? [])[0] ?? "en";
}

/** The language of this page, chosen once when it loads. */
export const language = languageOf(navigator.languages);

export const text: Catalogue = CATALOGUES[language];
