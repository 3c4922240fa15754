# Pelt for a web page: WebAssembly, by Debian's clang-14, lld-14, wasi-libc, libc++-16-dev-wasm32 and
# libclang-rt-14-dev-wasm32.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(CMAKE_CXX_COMPILER clang++)
set(CMAKE_CXX_COMPILER_TARGET wasm32-wasi)
# There is no library for exceptions: throw.cpp.
set(CMAKE_CXX_FLAGS_INIT "-fignore-exceptions")
# Kernels keep whole groups of chains on the stack: more than the 64 KiB of the default, which then runs over into
# other data, unseen. With the stack first, running out of it is a trap.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,-z,stack-size=1048576 -Wl,--stack-first")
