#!/usr/bin/env bash
# Installs what building Pelt needs, if it is missing. Where apt or the rights are not there it says exactly what
# to install and stops; with PELT_NO_INSTALL=1 it always does. Arguments: extra packages a caller needs.
set -euo pipefail
packages=(g++ cmake ninja-build libglm-dev libtbb-dev libbenchmark-dev libgtest-dev libtinygltf-dev libstb-dev
  nlohmann-json3-dev libtomlplusplus-dev libcli11-dev libfmt-dev libbullet-dev glslang-tools
  libegl-dev libgl-dev libcpp-httplib-dev relacy-dev "$@")
missing=()
for package in "${packages[@]}"; do
  if ! command -v dpkg-query >/dev/null || ! dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed'; then
    missing+=("$package")
  fi
done
[ "${#missing[@]}" -eq 0 ] && exit 0
if ! command -v apt-get >/dev/null; then
  echo "Pelt needs these Debian packages, and there is no apt-get here to install them: ${missing[*]}" >&2
  exit 1
fi
if [ -n "${PELT_NO_INSTALL:-}" ]; then
  echo "missing Debian packages: ${missing[*]}" >&2
  exit 1
fi
root=()
if [ "$(id -u)" -ne 0 ]; then
  if command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
    root=(sudo)
  else
    echo "Pelt needs packages that only root can install. Run:" >&2
    echo "  sudo apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 1
  fi
fi
echo "installing Debian packages, about a minute: ${missing[*]}"
apt() { "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o Acquire::Retries=3 -o DPkg::Lock::Timeout=120 -qq "$@" </dev/null; }
if ! { apt update && apt install -y --no-install-recommends "${missing[@]}" >/dev/null; }; then
  echo "apt-get could not install what Pelt needs (no network, or no Debian 12 package sources?). Missing:" >&2
  echo "  ${missing[*]}" >&2
  exit 1
fi
