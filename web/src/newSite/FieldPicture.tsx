import { For, Show } from "solid-js";
import { metresPerDegree } from "../map/localGrid";
import type { DrawnFeatureView } from "../protocol";
import { ringsOf } from "../site/siteFeatures";
import { text } from "../text/catalogue";

/** Radius of a pad, and room around the picture, in shares of its size. */
const PAD_SHARE = 0.015;
const ROOM_SHARE = 0.04;

/** The field with its boundary and pads, north up. */
export function FieldPicture(props: { layers: readonly DrawnFeatureView[] }) {
  const drawing = () => drawingOf(props.layers);
  return (
    <Show when={drawing()}>
      {(shown) => (
        <svg
          class="field-picture"
          viewBox={shown().viewBox}
          role="img"
          aria-label={text.newSite.picture}
        >
          <For each={shown().areas}>
            {({ layer, path }) => <path class={`field-picture-${layer}`} d={path} />}
          </For>
          <For each={shown().pads}>
            {([x, y]) => <circle class="field-picture-pad" cx={x} cy={y} r={shown().padRadius} />}
          </For>
        </svg>
      )}
    </Show>
  );
}

/** Paths in metres east and south of the first corner; null without a shape. */
function drawingOf(layers: readonly DrawnFeatureView[]) {
  const [first] = layers.flatMap(({ geometry }) => ringsOf(geometry).flat());
  if (first === undefined) return null;
  const per = metresPerDegree(first.lat);
  const shapes = layers.map(({ layer, geometry }) => ({
    layer,
    isPad: geometry.type === "Point",
    rings: ringsOf(geometry).map((ring) =>
      ring.map(
        ({ lon, lat }) => [(lon - first.lon) * per.lon, (first.lat - lat) * per.lat] as const,
      ),
    ),
  }));
  const points = shapes.flatMap(({ rings }) => rings.flat());
  const [xs, ys] = [points.map(([x]) => x), points.map(([, y]) => y)];
  const [west, north] = [Math.min(...xs), Math.min(...ys)];
  const [width, height] = [Math.max(...xs) - west, Math.max(...ys) - north];
  const size = Math.max(width, height);
  const room = size * ROOM_SHARE;
  const path = (ring: readonly (readonly [number, number])[]) =>
    `M${ring.map((point) => point.map((value) => value.toFixed(2)).join(" ")).join("L")}Z`;
  return {
    viewBox: [west - room, north - room, width + 2 * room, height + 2 * room].join(" "),
    areas: shapes
      .filter(({ isPad }) => !isPad)
      .map(({ layer, rings }) => ({ layer, path: rings.map(path).join("") })),
    pads: shapes.filter(({ isPad }) => isPad).flatMap(({ rings }) => rings.flat()),
    padRadius: size * PAD_SHARE,
  };
}
