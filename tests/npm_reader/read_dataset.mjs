// Reads both archives of a dataset through terray-server with the npm package pmtiles, the format's reference reader, by
// range requests alone, and holds what it finds against what the server says and sends.
//
// usage: node read_dataset.mjs http://HOST:PORT/NAME
// Exits with 1 and says what differs, where anything does.
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { PMTiles } from "pmtiles";

const sha256 = (bytes) => createHash("sha256").update(Buffer.from(bytes)).digest("hex");

async function fetchBytes(url) {
    const answer = await fetch(url);
    assert.ok(answer.ok, `${url}: ${answer.status}`);
    return { status: answer.status, bytes: await answer.arrayBuffer() };
}

/// The tile's address as its own header has it (common/FORMAT.md): magic, then level, x, y from byte 8.
function addressInside(bytes, magic) {
    const view = new DataView(bytes);
    assert.equal(Buffer.from(bytes, 0, 4).toString(), magic);
    return [8, 12, 16].map((offset) => view.getUint32(offset, true));
}

async function checkLayer(base, metadata, layer, magic) {
    const archive = new PMTiles(`${base}/${layer}.pmtiles`);
    const header = await archive.getHeader();
    assert.equal(header.specVersion, 3);
    assert.equal(header.minZoom, 0);
    assert.equal(header.maxZoom, metadata.layers[layer].maxzoom);
    assert.equal(header.numAddressedTiles, metadata[layer].tiles);
    for (const [name, value] of Object.entries(await archive.getMetadata()))
        assert.deepEqual(value, metadata[name], `metadata: ${name}`);

    let tiles = 0;
    for (let z = 0; z <= header.maxZoom; ++z)
        for (let x = 0; x < 2 ** z; ++x)
            for (let y = 0; y < 2 ** z; ++y) {
                const name = `${layer} ${z}/${x}/${y}`;
                const served = await fetchBytes(`${base}/${layer}/${z}/${x}/${y}`);
                const read = await archive.getZxy(z, x, y);
                assert.equal(read === undefined, served.status === 204, name);
                if (read === undefined) continue;
                assert.equal(sha256(read.data), sha256(served.bytes), name);
                assert.deepEqual(addressInside(read.data, magic), [z, x, y], name);
                ++tiles;
            }
    assert.equal(tiles, header.numAddressedTiles);
    console.log(`${layer}: header, metadata and ${tiles} tiles are the same`);
}

const base = process.argv[2];
const metadata = await (await fetch(`${base}/metadata.json`)).json();
await checkLayer(base, metadata, "heights", "TRYH");
await checkLayer(base, metadata, "imagery", "TRYI");
