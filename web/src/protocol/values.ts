/**
 * The values of an enumeration, in the order of a record that has them all. A list made so is complete: the compiler
 * names each record that a new value must enter.
 */
export function valuesOf<Value extends string>(
  record: Readonly<Record<Value, unknown>>,
): readonly Value[] {
  return Object.keys(record) as Value[];
}
