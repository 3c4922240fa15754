// Runs a WebAssembly program with files: node wasi.mjs PROGRAM ARGUMENT...
//
// What the programs here ask of WASI and no more. Node's own WASI is not used: in Node 20 it crashes a program that
// reads some megabytes.
import fs from 'node:fs';

const [program, ...args] = process.argv.slice(2);
const kBadFile = 8, kNoFile = 44, kNotHere = 52, kRegular = 4, kDirectory = 3, kTerminal = 2;
const kRoot = 3;  // the one folder that is open from the start
const files = [0, 1, 2, null].map((fd) => ({fd}));
let memory;

class Exit extends Error {
  constructor(code) {
    super(`exit ${code}`);
    this.code = code;
  }
}

const view = () => new DataView(memory.buffer);
const bytes = (at, size) => new Uint8Array(memory.buffer, at, size);
const text = (at, size) => new TextDecoder().decode(bytes(at, size));

function putStrings(strings, pointers, at) {
  for (const string of strings) {
    view().setUint32(pointers, at, true);
    pointers += 4;
    at += new TextEncoder().encodeInto(string + '\0', bytes(at, memory.buffer.byteLength - at)).written;
  }
  return 0;
}
function putSizes(strings, count, size) {
  view().setUint32(count, strings.length, true);
  view().setUint32(size, strings.reduce((sum, s) => sum + new TextEncoder().encode(s).length + 1, 0), true);
  return 0;
}
// move(fd, buffer) for each of a list of buffers, until one is not filled.
function eachBuffer(fd, list, count, done, move) {
  if (!files[fd]) return kBadFile;
  let all = 0;
  for (let i = 0; i < count; ++i) {
    const at = view().getUint32(list + 8 * i, true), size = view().getUint32(list + 8 * i + 4, true);
    const moved = size ? move(files[fd].fd, bytes(at, size)) : 0;
    all += moved;
    if (moved < size) break;
  }
  view().setUint32(done, all, true);
  return 0;
}

const argv = [program, ...args];
const calls = {
  args_get: (pointers, at) => putStrings(argv, pointers, at),
  args_sizes_get: (count, size) => putSizes(argv, count, size),
  environ_get: () => 0,
  environ_sizes_get: (count, size) => putSizes([], count, size),
  clock_time_get: (clock, precision, at) => {
    view().setBigUint64(at, process.hrtime.bigint(), true);
    return 0;
  },
  fd_close: (fd) => {
    if (!files[fd]) return kBadFile;
    if (fd > kRoot) fs.closeSync(files[fd].fd);
    files[fd] = undefined;
    return 0;
  },
  fd_fdstat_get: (fd, at) => {
    if (!files[fd]) return kBadFile;
    bytes(at, 24).fill(0);
    view().setUint8(at, fd === kRoot ? kDirectory : fd < kRoot ? kTerminal : kRegular);
    bytes(at + 8, 16).fill(255);  // every right
    return 0;
  },
  fd_fdstat_set_flags: () => 0,
  fd_prestat_get: (fd, at) => {
    if (fd !== kRoot) return kBadFile;
    view().setUint32(at, 0, true);
    view().setUint32(at + 4, 1, true);
    return 0;
  },
  fd_prestat_dir_name: (fd, at) => {
    bytes(at, 1).set([47]);
    return 0;
  },
  fd_read: (fd, list, count, done) => eachBuffer(fd, list, count, done, (file, to) => fs.readSync(file, to)),
  fd_write: (fd, list, count, done) => eachBuffer(fd, list, count, done, (file, from) => fs.writeSync(file, from)),
  path_open: (folder, follow, path, size, flags, rights, inherited, fdFlags, to) => {
    const kCreate = 1, kTruncate = 8, kMayWrite = 64n;
    const wanted = rights & kMayWrite ? (flags & kTruncate ? 'w' : 'a') : 'r';
    try {
      const fd = fs.openSync('/' + text(path, size), flags & kCreate || wanted === 'r' ? wanted : 'r+');
      view().setUint32(to, files.push({fd}) - 1, true);
      return 0;
    } catch {
      return kNoFile;
    }
  },
  proc_exit: (code) => {
    throw new Exit(code);
  },
};

const module = await WebAssembly.compile(fs.readFileSync(program));
const env = {};
for (const {module: from, name} of WebAssembly.Module.imports(module))
  (env[from] ??= {})[name] = calls[name] ?? (() => kNotHere);
const {exports} = await WebAssembly.instantiate(module, env);
memory = exports.memory;
try {
  exports._start();
} catch (error) {
  if (!(error instanceof Exit)) throw error;
  process.exitCode = error.code;
}
