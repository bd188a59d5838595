import type { FleetReturnView, ReturningView } from "../../protocol";

/** A stage as it is read after the vehicle's name. */
export const STAGES: Readonly<Record<ReturningView["stage"], string>> = {
  stopping: "stops",
  waiting: "waits",
  ordered: "is told to fly home",
  flying: "flies home",
  landed: "has landed",
  released: "is led by somebody else",
  left_out: "is left out",
};

/** Whether somebody must see to it: nobody flies it home. */
export function isStuck({ stage }: ReturningView): boolean {
  return stage === "left_out";
}

export function doneCount(view: FleetReturnView): number {
  return view.vehicles.filter(({ stage }) => stage === "landed").length;
}

/** Vehicles under one heading. */
export interface ReturnGroup {
  readonly title: string;
  readonly vehicles: readonly ReturningView[];
}

/** Those left out first, for they need somebody; then wave after wave, then those without a wave. */
export function stagesInTurn({ vehicles }: FleetReturnView): readonly ReturnGroup[] {
  const stuck = vehicles.filter(isStuck);
  const others = vehicles.filter((vehicle) => !isStuck(vehicle));
  const waves = [...new Set(others.flatMap(({ wave }) => wave ?? []))].sort((a, b) => a - b);
  const groups = [
    { title: "Left out: see to these", vehicles: stuck },
    ...waves.map((wave) => ({
      title: `Wave ${wave}`,
      vehicles: others.filter((vehicle) => vehicle.wave === wave),
    })),
    { title: "No wave yet", vehicles: others.filter(({ wave }) => wave === null) },
  ];
  return groups.filter((group) => group.vehicles.length > 0);
}
