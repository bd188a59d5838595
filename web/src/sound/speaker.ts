import { type Accessor, createSignal } from "solid-js";
import type { Severity } from "../protocol";
import { type Announcement, spokenText } from "./announcements";

/** Why there is no sound: the browser waits for a press on the page, or plays no sound at all. */
export type SoundProblem = "blocked" | "absent";

/** Makes announcements sound. */
export interface Speaker {
  /** A tone by severity, then the text where the browser has a voice. */
  announce(announcement: Announcement): void;
  isSpeaking(): boolean;
  /** As the last announcement found it; null while sound works. */
  readonly problem: Accessor<SoundProblem | null>;
  /** Whether the browser speaks without internet. */
  readonly hasVoice: Accessor<boolean>;
}

interface Tone {
  readonly count: number;
  readonly pitch_hz: number;
  readonly length_s: number;
}

/** Tones differ by number and pitch: in wind, or with poor hearing, one of the two is enough. */
export const TONES: Readonly<Record<Severity, Tone>> = {
  critical: { count: 3, pitch_hz: 988, length_s: 0.16 },
  error: { count: 2, pitch_hz: 740, length_s: 0.18 },
  warning: { count: 1, pitch_hz: 523, length_s: 0.25 },
  info: { count: 1, pitch_hz: 392, length_s: 0.2 },
};

const PAUSE_S = 0.1;
const LOUDNESS = 0.4;
/** Against a click at both ends. */
const RAMP_S = 0.015;
/** A context that has not started by then is blocked: its promise stays open until a press. */
const STARTS_WITHIN_MS = 1000;

/** The browser's sound: tones by Web Audio, speech by `speechSynthesis`. */
export function createSpeaker(page: Window & typeof globalThis): Speaker {
  const voices = page.speechSynthesis as SpeechSynthesis | undefined;
  const [problem, setProblem] = createSignal<SoundProblem | null>(null);
  const [voice, setVoice] = createSignal<SpeechSynthesisVoice | null>(null);
  let context: AudioContext | null = null;

  // Voices are loaded after the page.
  const findVoice = () => setVoice(localVoice(voices?.getVoices() ?? []));
  findVoice();
  voices?.addEventListener?.("voiceschanged", findVoice);

  /** Resolves with whether the browser lets the page sound. */
  const start = async (): Promise<boolean> => {
    if (page.AudioContext === undefined) {
      setProblem("absent");
      return false;
    }
    context ??= new page.AudioContext();
    const resumed = context.resume().then(
      () => true,
      () => false,
    );
    const late = new Promise<boolean>((resolve) => {
      page.setTimeout(() => resolve(false), STARTS_WITHIN_MS);
    });
    const hasStarted = await Promise.race([resumed, late]);
    setProblem(hasStarted ? null : "blocked");
    return hasStarted;
  };
  for (const press of ["pointerup", "keydown"] as const)
    page.addEventListener(press, () => {
      if (problem() === "blocked") void start();
    });

  const speak = (text: string) => {
    const chosen = voice();
    if (voices === undefined || chosen === null) return;
    const utterance = new page.SpeechSynthesisUtterance(spokenText(text));
    utterance.voice = chosen;
    utterance.lang = chosen.lang;
    voices.speak(utterance);
  };
  return {
    announce: ({ severity, text, interrupts }) => {
      if (interrupts) voices?.cancel();
      void start().then((hasStarted) => {
        if (!hasStarted || context === null) return;
        const lasts_s = play(context, TONES[severity]);
        page.setTimeout(() => speak(text), lasts_s * 1000);
      });
    },
    isSpeaking: () => voices?.speaking ?? false,
    problem,
    hasVoice: () => voice() !== null,
  };
}

/** An English voice of this computer: those of servers are silent without internet. */
function localVoice(voices: readonly SpeechSynthesisVoice[]): SpeechSynthesisVoice | null {
  const usable = voices.filter(({ lang, localService }) => localService && /^en\b/i.test(lang));
  return usable.find((voice) => voice.default) ?? usable[0] ?? null;
}

/** Plays a tone, and returns how long it lasts, seconds. */
function play(context: AudioContext, { count, pitch_hz, length_s }: Tone): number {
  const step_s = length_s + PAUSE_S;
  for (let index = 0; index < count; index += 1) {
    const begin_s = context.currentTime + index * step_s;
    const oscillator = new OscillatorNode(context, { type: "triangle", frequency: pitch_hz });
    const gain = new GainNode(context, { gain: 0 });
    gain.gain.setValueAtTime(0, begin_s);
    gain.gain.linearRampToValueAtTime(LOUDNESS, begin_s + RAMP_S);
    gain.gain.setValueAtTime(LOUDNESS, begin_s + length_s - RAMP_S);
    gain.gain.linearRampToValueAtTime(0, begin_s + length_s);
    oscillator.connect(gain).connect(context.destination);
    oscillator.start(begin_s);
    oscillator.stop(begin_s + length_s);
  }
  return count * step_s;
}
