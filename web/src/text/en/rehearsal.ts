/** A survey of one's own field by simulated drones, begun by one button. */
export const rehearsal = {
  title: "Rehearsal",
  what: (drones: number, region: string) =>
    drones === 1
      ? `1 simulated drone takes off and surveys ${region}.`
      : `${drones} simulated drones take off and survey ${region}.`,
  start: "Rehearse",
  of: (region: string) => `takeoff and survey of ${region}`,
};
