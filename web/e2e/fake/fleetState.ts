import type { StationState } from "../../src/protocol";
import { alarm, at, station, vehicle } from "../../src/testing/fakeState";

/** A large fleet: most fly rows side by side, some are on the ground, two are lost, and many come too close. */
export function fleetState(count: number, elapsed_s: number): StationState {
  const vehicles = Array.from({ length: count }, (_, index) => {
    const number = index + 1;
    const isGrounded = number % 8 === 0;
    const north_m = isGrounded ? -240 : ((elapsed_s * 8 + 90 * number) % 400) - 200;
    const east_m = isGrounded ? 6 * (number / 8) - 30 : 13 * index - 6.5 * count;
    const [longitude_deg, latitude_deg] = at(east_m, north_m);
    const isLost = number === 11 || number === 30;
    return vehicle(number, {
      name: `Drone ${number}`,
      is_simulated: true,
      is_flying: { value: !isGrounded, age_s: 0.1 },
      height_above_takeoff_m: { value: isGrounded ? 0 : 40 + 5 * (number % 5), age_s: 0.1 },
      position: { longitude_deg, latitude_deg, age_s: 0.1 },
      attitude: { yaw_deg: 0, pitch_deg: -4, roll_deg: 0, age_s: 0.1 },
      battery_fraction: { value: 0.95 - ((number * 7) % 60) / 100, age_s: 0.1 },
      track: [],
      ...(isLost ? { staleness: "lost" as const, telemetry_age_s: 6 + elapsed_s } : {}),
    });
  });
  return station(vehicles, {
    time_ns: 1e9 * (1 + elapsed_s),
    alarms: Array.from({ length: 31 }, (_, index) =>
      alarm(index + 1, {
        rule: "separation",
        severity: "error",
        vehicle_name: `Drone ${index + 1}`,
        text: `Drone ${index + 2} is 12 m away, minimum 15 m`,
      }),
    ),
  });
}
