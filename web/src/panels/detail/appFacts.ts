import type { VehicleView } from "../../protocol";
import { text } from "../../text/catalogue";
import { plainWords } from "../../text/names";
import { formatQuantity } from "../../text/quantities";
import { formatLength } from "../../text/units";
import type { Fact } from "./facts";

type AppFacts = NonNullable<VehicleView["app_facts"]>;

/** What a vehicle's app reports of its aircraft; only what it knows. Empty for a plain app. */
export function appFactsOf(vehicle: VehicleView): Fact[] {
  const facts = vehicle.app_facts;
  const known = facts === null ? [] : [...settings(facts), ...camera(facts), ...aircraft(facts)];
  const aged = known.map(([name, shown]) => ({ name, text: shown, ageS: vehicle.app_facts_age_s }));
  const photos = vehicle.photos;
  const { photosReported, photosWithout } = text.appFacts;
  const counted =
    photos === null
      ? []
      : [
          {
            name: photosReported,
            text:
              photos.missing > 0 ? photosWithout(photos.count, photos.missing) : `${photos.count}`,
            ageS: vehicle.newest_photo_age_s,
          },
        ];
  return [...aged, ...counted].map((each) => ({ ...each, why: null }));
}

type Line = readonly [name: string, shown: string];

function settings(facts: AppFacts): Line[] {
  const words = text.appFacts;
  return lines([
    [words.goHomeHeight, facts.go_home_height_m, (m) => formatLength(m)],
    [words.failsafe, facts.failsafe, (word) => words.failsafes[word] ?? plainWords(word)],
    [words.homePoint, home(facts), (place) => place],
    [words.maxHeight, facts.max_height_m, (m) => formatLength(m)],
    [words.maxDistance, facts.max_distance_m, (m) => formatLength(m)],
    [words.missions, facts.can_fly_missions, (can) => (can ? text.facts.yes : text.facts.no)],
    [words.djiCheck, facts.dji_check_passed, (ok) => (ok ? words.passed : words.failed)],
  ]);
}

function camera(facts: AppFacts): Line[] {
  const words = text.appFacts;
  return lines([
    [words.cameraMode, facts.camera_mode, plainWords],
    [words.photoInterval, facts.photo_interval_s, (s) => formatQuantity(s, "s")],
    [words.exposure, facts.exposure_locked, lockWord],
    [words.whiteBalance, facts.white_balance_locked, lockWord],
    [words.storagePhotos, facts.storage_left_photos, String],
    [words.storage, facts.storage_left_mb, (mb) => formatQuantity(mb / 1000, "GB")],
    [words.gimbalPitch, facts.gimbal_pitch_deg, (deg) => formatQuantity(deg, "°")],
  ]);
}

function aircraft(facts: AppFacts): Line[] {
  const words = text.appFacts;
  return lines([
    [words.cells, facts.battery_cells_v, cells],
    [words.batteryTemperature, facts.battery_temperature_c, (c) => formatQuantity(c, "°C", 0)],
    [words.rtk, facts.rtk, (state) => words.rtkStates[state] ?? state],
    [words.model, facts.model, String],
    [words.firmware, facts.firmware, String],
    [words.app, facts.app, String],
  ]);
}

/** The lines of what is known. */
// biome-ignore lint/suspicious/noExplicitAny: each line's value is of its own type
function lines(found: [string, any, (value: any) => string][]): Line[] {
  return found
    .filter(([, value]) => value !== null)
    .map(([name, value, format]) => [name, format(value)] as const);
}

function lockWord(isLocked: boolean): string {
  return isLocked ? text.appFacts.locked : text.appFacts.automatic;
}

function home(facts: AppFacts): string | null {
  const { home_latitude_deg: latitude, home_longitude_deg: longitude } = facts;
  if (latitude === null || longitude === null) return null;
  return `${formatQuantity(latitude, "°", 5)}, ${formatQuantity(longitude, "°", 5)}`;
}

function cells(volts: readonly number[]): string {
  const [least, most] = [Math.min(...volts), Math.max(...volts)];
  return text.appFacts.cellRange(volts.length, least.toFixed(2), most.toFixed(2));
}
