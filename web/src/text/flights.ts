/** When a record was begun, by its name: `2025-06-20 16:00`, UTC; any other name as it is. */
export function flightTime(name: string): string {
  const found = /^recon-(\d{4})(\d{2})(\d{2})T(\d{2})(\d{2})\d{2}Z(?:-(\d+))?$/.exec(name);
  if (found === null) return name;
  const [, year, month, day, hour, minute, number] = found;
  const time = `${year}-${month}-${day} ${hour}:${minute}`;
  return number === undefined ? time : `${time} (${number})`;
}
