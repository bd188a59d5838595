import { createServer } from "node:http";
import type { AddressInfo } from "node:net";
import { crc32, deflateSync } from "node:zlib";

const SIDE_PX = 256;

/** A tile server on loopback with a made landscape: fields of crops and stubble, tracks and trees. */
export async function startTileServer(): Promise<{ template: string; stop(): Promise<void> }> {
  const server = createServer((request, response) => {
    const [zoom = 0, col = 0, row = 0] = (request.url ?? "").slice(1).split(/[/.]/).map(Number);
    response.setHeader("Content-Type", "image/png");
    response.end(tile(zoom, col, row));
  });
  await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
  const { port } = server.address() as AddressInfo;
  return {
    template: `http://127.0.0.1:${port}/{z}/{x}/{y}.png`,
    stop: () => new Promise((resolve) => server.close(() => resolve())),
  };
}

function tile(zoom: number, col: number, row: number): Buffer {
  const lines = Buffer.alloc(SIDE_PX * (1 + 3 * SIDE_PX));
  const pixels = 2 ** (zoom + 8);
  for (let y = 0; y < SIDE_PX; y += 1) {
    for (let x = 0; x < SIDE_PX; x += 1) {
      // Metres on the ground, near 42 degrees.
      const east = ((col * SIDE_PX + x) / pixels) * 2.98e7;
      const south = ((row * SIDE_PX + y) / pixels) * 2.98e7;
      lines.set(landscape(east, south), y * (1 + 3 * SIDE_PX) + 1 + 3 * x);
    }
  }
  return png(lines);
}

/** A field every 90 m, rows every 4 m, a bright track between fields, and dark trees along it. */
function landscape(east: number, south: number): [number, number, number] {
  const field = noise(Math.floor(east / 90), Math.floor(south / 70));
  const [beside, along] = [east % 90, south % 70];
  const grain = 24 * (noise(Math.floor(east), Math.floor(south)) - 0.5);
  if (beside < 4) return [196 + grain, 182 + grain, 150 + grain];
  const tree = noise(Math.floor(east / 6), Math.floor(south / 6) + 7);
  if (along < 7 && tree > 0.45) return [38 + grain, 62 + grain, 34 + grain];
  const isRow = south % 4 < 1.5 ? 14 : 0;
  if (field > 0.6) return [186 - isRow + grain, 164 - isRow + grain, 108 - isRow + grain];
  if (field > 0.25) return [84 - isRow + grain, 122 - isRow + grain, 56 - isRow + grain];
  return [120 - isRow + grain, 96 - isRow + grain, 72 - isRow + grain];
}

/** The same number, 0 to 1, for the same place. */
function noise(x: number, y: number): number {
  const wave = Math.sin(x * 127.1 + y * 311.7) * 43758.5453;
  return wave - Math.floor(wave);
}

function png(lines: Buffer): Buffer {
  const header = Buffer.alloc(13);
  header.writeUInt32BE(SIDE_PX, 0);
  header.writeUInt32BE(SIDE_PX, 4);
  // Eight bits of red, green and blue.
  header.set([8, 2], 8);
  const signature = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
  const parts = [chunk("IHDR", header), chunk("IDAT", deflateSync(lines)), chunk("IEND")];
  return Buffer.concat([signature, ...parts]);
}

function chunk(kind: string, data = Buffer.alloc(0)): Buffer {
  const body = Buffer.concat([Buffer.from(kind), data]);
  const [length, check] = [Buffer.alloc(4), Buffer.alloc(4)];
  length.writeUInt32BE(data.length);
  check.writeUInt32BE(crc32(body));
  return Buffer.concat([length, body, check]);
}
