import { type ChildProcess, spawn } from "node:child_process";
import { existsSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

const PROJECT = fileURLToPath(new URL("../..", import.meta.url));
/** The folder of the demonstration's site, to be copied. */
export const DEMO_SITE = join(PROJECT, "src/recon/site/demo");
/** Where `make` installs uv if the system has none. */
const OWN_UV = ".tools/bin/uv";
const UV = existsSync(join(PROJECT, OWN_UV)) ? OWN_UV : "uv";
const COMMAND =
  process.env["RECON_E2E_COMMAND"] ?? `${UV} run --locked recon demo --http-port 0 --link-port 0`;
const STARTS_WITHIN_MS = 180_000;
const ENDS_WITHIN_MS = 10_000;

/** A station with simulated vehicles in its own process. */
export interface RunningStation {
  /** Address of its console. */
  readonly url: string;
  stop(): Promise<void>;
}

/** Starts `RECON_E2E_COMMAND` with these arguments and waits for the console address it prints. */
export function startStation(...args: string[]): Promise<RunningStation> {
  return started([COMMAND, ...args].join(" "));
}

/** Starts a replay of a flight record; its path may begin at the project's folder. */
export function startReplay(path: string, ...args: string[]): Promise<RunningStation> {
  const [program = ""] = COMMAND.split(" demo ");
  return started(`${program} replay ${[path, "--http-port 0", ...args].join(" ")}`);
}

async function started(command: string): Promise<RunningStation> {
  const station = spawn(command, {
    cwd: PROJECT,
    shell: true,
    detached: true,
  });
  try {
    return { url: await consoleAddress(station), stop: () => stop(station) };
  } catch (error) {
    await stop(station);
    throw error;
  }
}

/** Runs another command of the same program to its end. */
export async function runRecon(...args: string[]): Promise<void> {
  const [program = ""] = COMMAND.split(" demo ");
  const ended = spawn([program, ...args].join(" "), { cwd: PROJECT, shell: true });
  let output = "";
  ended.stdout.on("data", (chunk: Buffer) => (output += chunk.toString()));
  ended.stderr.on("data", (chunk: Buffer) => (output += chunk.toString()));
  const code = await new Promise((resolve) => ended.once("exit", resolve));
  if (code !== 0) throw new Error(`recon ${args.join(" ")} ended with ${code}. Output:\n${output}`);
}

function consoleAddress(station: ChildProcess): Promise<string> {
  return new Promise((resolve, reject) => {
    let output = "";
    const fail = (why: string) => reject(new Error(`"${COMMAND}" ${why}. Output:\n${output}`));
    const timer = setTimeout(() => fail("printed no console address"), STARTS_WITHIN_MS);
    const listen = (chunk: Buffer) => {
      output += chunk.toString();
      const url = /^console: (http:\/\/\S+)/m.exec(output)?.[1];
      if (url === undefined) return;
      clearTimeout(timer);
      resolve(url);
    };
    station.stdout?.on("data", listen);
    station.stderr?.on("data", listen);
    station.once("exit", (code) => {
      clearTimeout(timer);
      fail(`ended with ${code}`);
    });
  });
}

/** Ends the station and its children: SIGINT first, SIGKILL after a timeout. */
async function stop(station: ChildProcess): Promise<void> {
  const { pid } = station;
  if (pid === undefined || station.exitCode !== null) return;
  const ended = new Promise((resolve) => station.once("exit", resolve));
  process.kill(-pid, "SIGINT");
  const timer = setTimeout(() => process.kill(-pid, "SIGKILL"), ENDS_WITHIN_MS);
  await ended;
  clearTimeout(timer);
}
