// ---- Files as one .zip ------------------------------------------------------------------------------------------------

// Written without compression, which maps as PNG have of their own; read with it too.
function crc32(bytes) {
  let crc = -1;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; ++bit) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc >>> 0;
}

// Numbers of 2 or 4 bytes, the lowest first: 'w' or 'd' for each.
function packed(kinds, ...values) {
  const bytes = new Uint8Array([...kinds].reduce((sum, kind) => sum + (kind === 'w' ? 2 : 4), 0)), view = new DataView(bytes.buffer);
  let at = 0;
  for (const [i, kind] of [...kinds].entries()) {
    if (kind === 'w') view.setUint16(at, values[i], true);
    else view.setUint32(at, values[i], true);
    at += kind === 'w' ? 2 : 4;
  }
  return bytes;
}

// Version 2.0, names in UTF-8, stored, of the first day that the format knows.
const kZipKind = [20, 0x0800, 0, 0, 0x21];

// {name: bytes} as the parts of a file.
function zipParts(files) {
  const parts = [], directory = [];
  let at = 0, directoryBytes = 0;
  const add = (to, ...pieces) => {
    to.push(...pieces);
    return pieces.reduce((sum, piece) => sum + piece.length, 0);
  };
  for (const [name, bytes] of Object.entries(files)) {
    const path = new TextEncoder().encode(name), kind = [...kZipKind, crc32(bytes), bytes.length, bytes.length, path.length, 0];
    directoryBytes += add(directory, packed('dwwwwwwdddwwwwwdd', 0x02014b50, 20, ...kind, 0, 0, 0, 0, at), path);
    at += add(parts, packed('dwwwwwdddww', 0x04034b50, ...kind), path, bytes);
  }
  const count = Object.keys(files).length;
  return [...parts, ...directory, packed('dwwwwddw', 0x06054b50, 0, 0, count, count, directoryBytes, at, 0)];
}

async function unzip(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length), files = {};
  let end = bytes.length - 22;
  while (end >= 0 && view.getUint32(end, true) !== 0x06054b50) --end;
  if (end < 0) throw new Error('it is no .zip, or it was cut');
  let at = view.getUint32(end + 16, true);
  for (let left = view.getUint16(end + 10, true); left > 0; --left) {
    if (view.getUint32(at, true) !== 0x02014b50) throw new Error('its directory is damaged');
    const [flags, method] = [8, 10].map((by) => view.getUint16(at + by, true));
    const [crc, size] = [16, 20].map((by) => view.getUint32(at + by, true)), from = view.getUint32(at + 42, true);
    const [path, extra, comment] = [28, 30, 32].map((by) => view.getUint16(at + by, true));
    const name = new TextDecoder().decode(bytes.subarray(at + 46, at + 46 + path));
    at += 46 + path + extra + comment;
    if (name.endsWith('/')) continue;
    if ((flags & 1) || ![0, 8].includes(method)) throw new Error(`${name}: encrypted, or packed by method ${method}; 0 and 8 are read`);
    const begin = from + 30 + view.getUint16(from + 26, true) + view.getUint16(from + 28, true);
    const stored = bytes.slice(begin, begin + size);
    const inflated = () => new Response(new Blob([stored]).stream().pipeThrough(new DecompressionStream('deflate-raw'))).arrayBuffer();
    files[name] = method === 0 ? stored : new Uint8Array(await inflated());
    if (crc32(files[name]) !== crc) throw new Error(`${name}: damaged`);
  }
  return files;
}
